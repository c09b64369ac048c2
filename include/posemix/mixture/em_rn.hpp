// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include <Eigen/Cholesky>

#include "posemix/mixture/em_gaussian.hpp"

namespace posemix::internal {

/// One component in one iteration, on R^n, with vector instructions. N may be Eigen::Dynamic.
template <int N>
class EmGaussianWorker<Rnd<N>> {
 public:
  using Density = ConcentratedGaussian<Rnd<N>>;
  using Tangent = typename Rnd<N>::Tangent;
  using Covariance = typename Rnd<N>::TangentMatrix;
  using Samples = EmCoordinates;

  EmGaussianWorker(const Density& density, const EmSettings& settings)
      : density_(density),
        settings_(&settings),
        factor_(density.covariance()),
        kernel_(kernel_of(density)) {
    sums_.resize((1 + kernel_.mean.size() + kernel_.factor.size()) * kEmSumLanes);
  }

  void log_density(const Samples& samples, std::size_t begin, std::size_t count, EmRow& out) {
    block_ = samples.block(begin);
    count_ = count;
    rn_log_density(block_, count, kernel_, out);
  }

  void accumulate(const EmRow& shares) {
    add_rn_moments(block_, shares, count_, kernel_, sums_.data());
  }

  double weight() const { return em_total(sums_.data(), 0); }
  Density update(double step) const { return moments().update(density_, *settings_, step); }

  /// The moments accumulated so far.
  EmGaussianMoments<Rnd<N>> moments() const {
    const std::size_t n = kernel_.mean.size();
    EmGaussianMoments<Rnd<N>> moments(density_.dof());
    moments.weight = weight();
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      moments.first[row] = em_total(sums_.data(), 1 + i);
      for (std::size_t j = 0; j <= i; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        moments.second(row, column) = em_total(sums_.data(), em_second_moment(n, i, j));
        moments.second(column, row) = moments.second(row, column);
      }
    }
    moments.gradient = factor_.solve(moments.first);
    return moments;
  }

 private:
  Density density_;
  const EmSettings* settings_;
  Eigen::LLT<Covariance> factor_;  ///< of the covariance
  RnKernel kernel_;
  const EmRow* block_ = nullptr;  ///< samples of the last log_density
  std::size_t count_ = 0;
  std::vector<double> sums_;
};

}  // namespace posemix::internal
