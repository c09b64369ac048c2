// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "posemix/base/error.hpp"

namespace posemix::internal {

/// A part of a Gaussian in a vector space.
template <class Vector, class Matrix>
struct GaussianPart {
  double weight;
  double log_weight;  ///< logarithm of the weight, accumulated over the splits
  Vector mean;
  Matrix covariance;
};

/// The standard deviation s of the three narrower Gaussians that replace a standard normal density:
/// with weights 1/6, 2/3, 1/6 at -a, 0, a and a^2 = 3 (1 - s^2) they keep the moments up to the
/// fifth. The Kullback-Leibler divergence is 0.0013.
inline constexpr double kSplitDeviation = 0.7;

/// The largest standard deviation of the first three coordinates, and its direction.
template <class Matrix>
std::pair<double, Eigen::Vector3d> widest(const Matrix& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
      Eigen::Matrix3d(covariance.template topLeftCorner<3, 3>()));
  return {std::sqrt(axes.eigenvalues()[2]), axes.eigenvectors().col(2)};
}

/// A Gaussian as a sum of Gaussians whose standard deviations in the first three coordinates are at
/// most `max_spread`: the widest direction is split in three until all are narrow enough. The
/// weights sum to one.
/// @throws InvalidInput when max_spread is not positive, or more than 1000 parts would be needed
template <class Vector, class Matrix>
std::vector<GaussianPart<Vector, Matrix>> split_gaussian(const Vector& mean,
                                                         const Matrix& covariance,
                                                         double max_spread) {
  using Part = GaussianPart<Vector, Matrix>;
  constexpr std::size_t kMostParts = 1000;
  const double away = std::sqrt(3.0 * (1.0 - kSplitDeviation * kSplitDeviation));
  require(max_spread > 0.0, "split: max_spread must be positive");
  std::vector<Part> open{{1.0, 0.0, mean, covariance}};
  std::vector<Part> parts;
  while (!open.empty()) {
    if (open.size() + parts.size() > kMostParts) {
      throw InvalidInput(
          fmt::format("split: more than {} pieces for a max_spread of {}", kMostParts, max_spread));
    }
    const Part part = std::move(open.back());
    open.pop_back();
    const auto [spread, axis] = widest(part.covariance);
    if (!(spread > max_spread)) {
      parts.push_back(part);
      continue;
    }
    // The other coordinates of the parts' means follow by linear regression on the split axis.
    const Vector along = part.covariance.template leftCols<3>() * axis / spread;
    const Matrix narrower =
        part.covariance - (1.0 - kSplitDeviation * kSplitDeviation) * along * along.transpose();
    const double log_outer = part.log_weight + std::log(1.0 / 6.0);
    const double log_inner = part.log_weight + std::log(2.0 / 3.0);
    open.push_back({part.weight / 6.0, log_outer, part.mean - away * along, narrower});
    open.push_back({part.weight / 1.5, log_inner, part.mean, narrower});
    open.push_back({part.weight / 6.0, log_outer, part.mean + away * along, narrower});
  }
  return parts;
}

}  // namespace posemix::internal
