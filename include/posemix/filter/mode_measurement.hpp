// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/linear.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// The covariance of a noise component with which a detection moves the estimate.
enum class GainCovariance {
  likelihood,  ///< NoiseComponent::covariance, which also weighs hypotheses
  update       ///< NoiseComponent::update_covariance where the component has one
};

/// One detection as a Gaussian factor on the difference d = xi_O - xi_C, both in the world frame in
/// the tangent spaces at given poses: log p = -1/2 d^T information d + pull^T d, up to a constant.
struct ModeMeasurement {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  double inlier_probability = 0.0;   ///< probability of the noise's first component
  double clutter_probability = 1.0;  ///< probability of clutter
};

/// The expectation step of expectation-maximisation over the noise's components and clutter
/// (docs/filter.md): the sum of the components' information R_c^-1, weighted by their posterior
/// probabilities. Clutter adds no information.
///
/// `camera` and `object` are T_world_camera and T_world_object, `detected` is T_camera_object.
/// `difference` is the covariance of d with which the probabilities are computed;
/// `gain_covariance` chooses R_c, as in MultiObjectFilter.
ModeMeasurement measure_mode(const SE3d& camera, const SE3d& object, const Matrix6d& difference,
                             const SE3d& detected, const ObjectSensor& sensor,
                             GainCovariance gain_covariance);

}  // namespace posemix
