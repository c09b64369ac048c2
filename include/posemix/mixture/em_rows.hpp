// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "posemix/lie/lie.hpp"

namespace posemix {

/// The largest number of samples in a block, so small that intermediate results stay in the cache.
inline constexpr std::size_t kEmBlock = 256;

/// One value for every sample of a block, aligned for vector instructions.
struct alignas(64) EmRow {
  std::array<double, kEmBlock> values{};

  double* data() { return values.data(); }
  const double* data() const { return values.data(); }
  double& operator[](std::size_t i) { return values[i]; }
  double operator[](std::size_t i) const { return values[i]; }
};

/// Elements for EM, coordinate by coordinate within each block: rows qx qy qz qw for rotations, and
/// tx ty tz [m] for poses; one row for each coordinate of vectors. The last block is filled up with
/// identities.
class EmCoordinates {
 public:
  explicit EmCoordinates(std::span<const SO3d> elements);
  explicit EmCoordinates(std::span<const SE3d> elements);
  /// @throws InvalidInput when the dimensions differ
  template <int N>
  explicit EmCoordinates(std::span<const Rnd<N>> elements)
      : EmCoordinates(elements.size(), elements.empty() ? 0 : elements.front().dof()) {
    for (std::size_t i = 0; i < size_; ++i) {
      check_dimensions(i, elements[i].dof());
      EmRow* rows = rows_.data() + i / kEmBlock * dimensions_;
      for (std::size_t j = 0; j < dimensions_; ++j)
        rows[j][i % kEmBlock] = elements[i].value()[static_cast<Eigen::Index>(j)];
    }
  }

  std::size_t size() const { return size_; }
  /// The rows of the block that begins at the sample `begin`, a multiple of kEmBlock.
  const EmRow* block(std::size_t begin) const {
    return rows_.data() + begin / kEmBlock * dimensions_;
  }

 private:
  /// Zeros.
  EmCoordinates(std::size_t size, Eigen::Index dimensions);
  void check_dimensions(std::size_t index, Eigen::Index dimensions) const;

  std::size_t dimensions_;
  std::size_t size_;
  std::vector<EmRow> rows_;
};

namespace internal {

/// Sums over samples are kept as one partial sum per vector lane, at most so many of them.
inline constexpr std::size_t kEmSumLanes = 8;

/// Sum number k.
inline double em_total(const double* sums, std::size_t k) {
  double sum = 0.0;
  for (std::size_t lane = 0; lane < kEmSumLanes; ++lane) sum += sums[k * kEmSumLanes + lane];
  return sum;
}

/// kCount sums.
template <std::size_t kCount>
class EmSums {
 public:
  double* data() { return lanes_.data(); }
  double total(std::size_t i) const { return em_total(lanes_.data(), i); }

 private:
  std::array<double, kCount * kEmSumLanes> lanes_{};
};

/// The position of E[y_i y_j], i >= j, among the sums over y of n coordinates, which are in order:
/// the weight, the n first moments, the lower triangle of the second moments row by row, further
/// sums.
constexpr std::size_t em_second_moment(std::size_t n, std::size_t i, std::size_t j) {
  return 1 + n + i * (i + 1) / 2 + j;
}

/// Turns a block of log densities in rows, one per component, into shares in place; shares below
/// 1e-30 become zero. Returns the sum of weight times log density of the mixture.
double shares_from_log_terms(const EmRow& weights, std::size_t count, std::span<EmRow> terms);

/// log sum_k exp(log_weights_k + terms_k) for a block of log densities in rows, one per component;
/// -inf where all are, and not a number where one is not.
void log_sums(std::span<const double> log_weights, std::size_t count, std::span<const EmRow> terms,
              EmRow& out);

}  // namespace internal
}  // namespace posemix
