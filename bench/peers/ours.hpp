// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "jobs.hpp"
#include "posemix/density/operations.hpp"

/// How the arrays that all programs read and write are those of the library.
namespace posemix {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline std::vector<SE3d> poses_of(const std::vector<double>& numbers) {
  std::vector<SE3d> poses;
  for (std::size_t i = 0; i < numbers.size(); i += 16) {
    poses.push_back(SE3d::from_matrix(
        Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&numbers[i])));
  }
  return poses;
}

/// Square matrices, each row by row.
template <int kSize = 6>
std::vector<Eigen::Matrix<double, kSize, kSize>> matrices_of(const std::vector<double>& numbers) {
  std::vector<Eigen::Matrix<double, kSize, kSize>> matrices;
  for (std::size_t i = 0; i < numbers.size(); i += kSize * kSize)
    matrices.emplace_back(Eigen::Map<const RowMajor>(&numbers[i], kSize, kSize));
  return matrices;
}

inline std::vector<Vector6d> vectors_of(const std::vector<double>& numbers) {
  std::vector<Vector6d> vectors;
  for (std::size_t i = 0; i < numbers.size(); i += 6) vectors.emplace_back(&numbers[i]);
  return vectors;
}

inline void append(std::vector<double>& numbers, const RowMajor& m) {
  numbers.insert(numbers.end(), m.data(), m.data() + m.size());
}
inline void append(std::vector<double>& numbers, const SE3d& pose) {
  append(numbers, RowMajor(pose.matrix()));
}
inline void append(std::vector<double>& numbers, const SO3d& rotation) {
  append(numbers, RowMajor(rotation.matrix()));
}
inline void append(std::vector<double>& numbers, const Rnd<6>& element) {
  append(numbers, RowMajor(element.value()));
}
template <class G>
void append(std::vector<double>& numbers, const ConcentratedGaussian<G>& density) {
  append(numbers, density.mean());
  append(numbers, RowMajor(density.covariance()));
}

template <class Out>
std::vector<double> flat(const std::vector<Out>& values) {
  std::vector<double> numbers;
  for (const Out& value : values) append(numbers, value);
  return numbers;
}

/// Runs `one` for each of as many items as `found` has.
template <class Found, class One>
void each_job(bench::Jobs& jobs, const std::string& name, std::vector<Found>& found,
              const One& one) {
  bench::run_each(jobs, name, found, one, [](const auto& values) { return flat(values); });
}

void filter_jobs(bench::Jobs& jobs);   ///< merges and frames
void mixture_jobs(bench::Jobs& jobs);  ///< divergence, reduction, EM, log densities

}  // namespace posemix
