// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "posemix/lie/lie.hpp"

namespace posemix {

/// At most this many samples in a block: what is computed of them stays in the cache.
inline constexpr std::size_t kEmBlock = 256;

/// One value for every sample of a block, aligned for vector instructions.
struct alignas(64) EmRow {
  std::array<double, kEmBlock> values{};

  double* data() { return values.data(); }
  const double* data() const { return values.data(); }
  double& operator[](std::size_t i) { return values[i]; }
  double operator[](std::size_t i) const { return values[i]; }
};

/// Rotations or poses for EM, coordinate by coordinate within each block: rows qx qy qz qw, and for
/// poses tx ty tz [m]. The last block is filled up with identities.
class EmCoordinates {
 public:
  explicit EmCoordinates(std::span<const SO3d> elements);
  explicit EmCoordinates(std::span<const SE3d> elements);

  std::size_t size() const { return size_; }
  /// The rows of the block that begins at the sample `begin`, a multiple of kEmBlock.
  const EmRow* block(std::size_t begin) const { return &rows_[begin / kEmBlock * dimensions_]; }

 private:
  std::size_t dimensions_;
  std::size_t size_;
  std::vector<EmRow> rows_;
};

namespace internal {

/// Sums over samples, each kept in as many parts as vectors have lanes.
template <std::size_t kCount>
class EmSums {
 public:
  double* data() { return lanes_.data(); }
  double total(std::size_t i) const {
    double sum = 0.0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) sum += lanes_[i * kLanes + lane];
    return sum;
  }

 private:
  static constexpr std::size_t kLanes = 8;
  alignas(64) std::array<double, kCount * kLanes> lanes_{};
};

/// Where E[y_i y_j], i >= j, lies among the sums over y of n coordinates: their weight, the n first
/// moments, the lower triangle of the second moments row by row, and then further sums.
constexpr std::size_t em_second_moment(std::size_t n, std::size_t i, std::size_t j) {
  return 1 + n + i * (i + 1) / 2 + j;
}

/// A block of log densities in rows, one per component, becomes shares in place, those below 1e-30
/// zero; returns the sum of weight times log density of the mixture.
double shares_from_log_terms(const EmRow& weights, std::size_t count, std::span<EmRow> terms);

}  // namespace internal
}  // namespace posemix
