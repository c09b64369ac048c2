// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/symmetry.hpp"

namespace posemix {

/// A model of the detections of one object: their error, and the poses that look the same.
struct ObjectSensor {
  DetectorNoise noise;
  SymmetryGroup symmetries = {};
  /// The noise of further detectors of the object. All detectors are taken to have one slow error,
  /// each in its own units: what misleads one misleads the others.
  std::vector<DetectorNoise> other_detectors = {};
  /// From the slow error of the object's first detector that has one to that of this detector. None
  /// is the identity.
  std::optional<Matrix6d> slow_units = {};
  /// Factors on the standard deviations of the noise, along its own axes.
  Vector6d noise_scale = Vector6d::Ones();
  /// The same for the slow part of the error.
  Vector6d slow_scale = Vector6d::Ones();

  /// Stationary covariance of the slow error with its scale; none where the noise has no slow part.
  std::optional<Matrix6d> slow_covariance() const {
    const auto& slow = noise.dependence().slow;
    if (!slow) return std::nullopt;
    return Matrix6d(slow_scale.asDiagonal() * slow->covariance * slow_scale.asDiagonal());
  }

  /// Covariance of the error in common, of which detections tell nothing.
  std::optional<Matrix6d> common_covariance() const { return noise.dependence().common; }
};

}  // namespace posemix
