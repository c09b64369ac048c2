// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>

#include "posemix/density/concentrated_gaussian.hpp"

namespace posemix {

/// Variance of each coordinate of the logarithm of a rotation that may be any [rad^2].
inline constexpr double kUniformRotationVariance =
    (std::numbers::pi * std::numbers::pi / 3.0 + 2.0) / 3.0;

/// What is known of an object's pose before it is seen, as of a surveyed landmark.
struct ObjectPrior {
  ConcentratedGaussian<SE3d> world;  ///< T_world_object, independent of the camera and the others
  /// Probability that this holds. Else the object may be anywhere, and detections that the prior
  /// does not explain begin other hypotheses.
  double probability = 0.95;
};

}  // namespace posemix
