// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/lie/lie.hpp"

/// Camera and one hypothesis of one object: what a detection speaks about. In the room `filter`
/// only.
namespace posemix::internal {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// Joint Gaussian of camera and object, [xi_C; xi_O], both in the world frame.
struct Pair {
  SE3d camera;
  SE3d object;
  Matrix12d covariance;

  SE3d camera_object() const { return camera.inverse() * object; }
  /// Covariance of xi_O - xi_C, H P H^T with H = [-I I].
  Matrix6d difference() const {
    const Matrix6d cross = covariance.bottomLeftCorner<6, 6>();
    return covariance.topLeftCorner<6, 6>() + covariance.bottomRightCorner<6, 6>() - cross -
           cross.transpose();
  }
};

/// Moments of a pair, in the tangent spaces at its means before the detection.
struct PairMoments {
  Vector12d mean = Vector12d::Zero();
  Matrix12d covariance = Matrix12d::Zero();
};

/// What a detection says to one pair.
struct PairUpdate {
  PairMoments posterior;
  double log_evidence = 0.0;         ///< of all noise components and clutter [nats]
  double squared_distance = 0.0;     ///< least squared Mahalanobis distance over the components
  double inlier_probability = 0.0;   ///< posterior probability of the first component
  double clutter_probability = 0.0;  ///< and of clutter
  /// Innovation of the first component along the axes of its noise, and its expected variance.
  Vector6d residual = Vector6d::Zero();
  Vector6d residual_variance = Vector6d::Ones();
};

/// Noise, clutter and symmetries as in `sensor`; `camera_gain_noise` multiplies the noise with
/// which the camera's gain is computed (infinity: the camera is not moved). Without `averages` the
/// update is by the covariance that weighs.
PairUpdate observe(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor,
                   double camera_gain_noise, bool averages);

/// One component as it is seen from a pair: z = Log(T_C Y offset^-1 T_O^-1) with its covariances,
/// all in the world frame.
struct PairInnovation {
  Vector6d residual;
  Matrix6d noise;
  Matrix6d update_noise;
  SE3d axes;  ///< of the noise, in the world frame
};

/// Covariance of one component's noise, in the world frame.
Matrix6d component_noise(const Pair& pair, const NoiseComponent& component,
                         const ObjectSensor& sensor);

PairInnovation innovation(const Pair& pair, const SE3d& detected, const NoiseComponent& component,
                          const ObjectSensor& sensor);

/// What a detection may be: one component of its noise, or clutter.
struct Explanation {
  std::vector<PairInnovation> innovations;  ///< one per component
  std::vector<double> shares;               ///< posterior probabilities; clutter's is last
  double log_evidence = 0.0;
  double squared_distance = 0.0;  ///< least squared Mahalanobis distance over the components
};

/// Shares are not numbers where the evidence is zero.
Explanation explain(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor);

}  // namespace posemix::internal
