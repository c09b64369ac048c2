// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/symmetry.hpp"

namespace posemix {

/// A model of the detections of one object: their error, and the poses that look the same.
struct ObjectSensor {
  DetectorNoise noise;
  SymmetryGroup symmetries = {};
  /// Factors on the standard deviations of the noise, along its own axes.
  Vector6d noise_scale = Vector6d::Ones();
};

}  // namespace posemix
