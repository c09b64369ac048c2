// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/linear.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// What one detection says about xi_O - xi_C, both in the world frame in the tangent spaces at the
/// poses where it was taken: log p = -1/2 d^T information d + pull^T d, up to a constant.
struct ModeMeasurement {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  double inlier_probability = 0.0;   ///< probability of the noise's first component
  double clutter_probability = 1.0;  ///< that the detection is of nothing
};

/// The expectation step of expectation-maximisation over the noise's components and clutter
/// (docs/filter.md): the components' information R_i^-1 by their posterior probabilities, clutter
/// saying nothing. `difference` is the covariance of xi_O - xi_C under which they are weighed. With
/// `averages` a component says as much as its update covariance, as in MultiObjectFilter with
/// odometry.
ModeMeasurement measure_mode(const SE3d& camera, const SE3d& object, const Matrix6d& difference,
                             const SE3d& detected, const ObjectSensor& sensor, bool averages);

}  // namespace posemix
