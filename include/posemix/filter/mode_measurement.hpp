// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/linear.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// Camera and object, T_world_camera and T_world_object, and the slow error b of the object's
/// detector in the frame and the units of its noise.
struct ModeState {
  SE3d camera;
  SE3d object;
  Vector6d slow = Vector6d::Zero();
  /// Of [xi_O - xi_C; b], world frame.
  Eigen::Matrix<double, 12, 12> covariance = Eigen::Matrix<double, 12, 12>::Zero();
};

/// One detection as a Gaussian factor on d = xi_O - xi_C + A (b - b0), in the world frame in the
/// tangent spaces at given poses: log p = -1/2 d^T information d + pull^T d, up to a constant.
struct ModeMeasurement {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  /// A, from the frame and the units of the noise to the world frame.
  Matrix6d slow_map = Matrix6d::Zero();
  double inlier_probability = 0.0;   ///< probability of the noise's first component
  double clutter_probability = 1.0;  ///< probability of clutter
  /// Index of the most probable component among those of a weight above zero.
  std::size_t best_component = 0;
};

/// The expectation step of expectation-maximisation over the noise's components and clutter
/// (docs/filter.md): the sum of the components' information R_c^-1, weighted by their posterior
/// probabilities. Clutter adds no information. A is that of the most probable component.
///
/// `detected` is T_camera_object; the covariance of `state` is that with which the probabilities
/// are computed.
ModeMeasurement measure_mode(const ModeState& state, const SE3d& detected,
                             const ObjectSensor& sensor);
/// The same for an observation with several components; their weights count as one more factor.
/// @throws InvalidInput as validate(observation)
ModeMeasurement measure_mode(const ModeState& state, const Observation& observation,
                             const ObjectSensor& sensor);

}  // namespace posemix
