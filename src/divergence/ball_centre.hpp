// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "density_factors.hpp"
#include "rotation_ray.hpp"

namespace posemix::internal {

/// The rounding error of a log density.
inline constexpr double kLogRounding = 4e-15;

/// An integrand, and how rounding of the log densities reaches it.
struct Integrand {
  DensityFactor factor;
  double scale;      ///< about the largest value of densities in it; 1 for log densities
  bool is_positive;  ///< of second order in the difference of the log densities

  /// The rounding error of a weighted mean of the factor whose absolute value is so large.
  double rounding(double absolute) const {
    if (!is_positive) return kLogRounding * scale;
    return kLogRounding * std::sqrt(2.0 * absolute * scale) + kLogRounding * kLogRounding * scale;
  }
};

/// A peak about which to integrate.
struct BallCentre {
  const RotationPeak* peak;
  double share;  ///< in the sum of the integrals; negative if it is subtracted
  /// The square root of its covariance, with orthogonal columns, in the coordinates of the rule.
  Eigen::Matrix3d root;

  /// The factor of the integral of exp(-|x|^2 / 2) G(x) over the whitened coordinates.
  double factor() const { return share * peak->weight * std::exp(-1.5 * kLogTwoPi); }
};

}  // namespace posemix::internal
