// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/symmetry.hpp"

namespace posemix {

/// How one object is seen: the error of its detections, and the poses that look the same.
struct ObjectSensor {
  DetectorNoise noise;
  SymmetryGroup symmetries = {};
  /// Factors of the noise's standard deviations along its own axes.
  Vector6d noise_scale = Vector6d::Ones();
};

}  // namespace posemix
