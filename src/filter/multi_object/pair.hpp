// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/filter/mode_measurement.hpp"
#include "posemix/lie/lie.hpp"

/// The camera and one hypothesis of one object: the two poses that a detection depends on.
namespace posemix::internal {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// The Gaussian of camera and object, [xi_C; xi_O], both in the world frame.
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

/// One detection under one noise component, seen from a pair: eq. (2) of docs/many-objects.md. All
/// values are in the world frame.
struct PairInnovation {
  Vector6d residual;      ///< z = Log(T_C Y offset^-1 T_O^-1)
  Matrix6d noise;         ///< covariance in the likelihood, R
  Matrix6d update_noise;  ///< covariance in the gain, R'
  SE3d axes;              ///< the axes in which the noise is stated
};

/// R or R', the covariance that the gain is computed with.
inline const Matrix6d& noise_in_gain(const PairInnovation& seen, GainCovariance gain_covariance) {
  return gain_covariance == GainCovariance::update ? seen.update_noise : seen.noise;
}

PairInnovation innovation(const Pair& pair, const SE3d& detected, const NoiseComponent& component,
                          const ObjectSensor& sensor);

/// Covariance of one component's noise in the world frame, without the unobserved directions of a
/// symmetry.
Matrix6d component_noise(const Pair& pair, const NoiseComponent& component,
                         const ObjectSensor& sensor);

/// A detection of a pair under all components of the noise and clutter, eq. (3). The probabilities
/// are not numbers where the evidence is zero.
struct Explanation {
  std::vector<PairInnovation> innovations;  ///< one per component
  std::vector<double> probabilities;        ///< a_c, one per component; clutter's is last
  double log_evidence = 0.0;                ///< log sum_c exp e_c, clutter included [nats]
  double squared_distance = 0.0;  ///< least squared Mahalanobis distance over the components
};

Explanation explain(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor);

/// The update of one pair by a detection, eq. (4).
struct PairUpdate {
  PairMoments posterior;
  double log_evidence = 0.0;         ///< of all noise components and clutter [nats]
  double squared_distance = 0.0;     ///< least squared Mahalanobis distance over the components
  double inlier_probability = 0.0;   ///< posterior probability of the first component
  double clutter_probability = 0.0;  ///< posterior probability of clutter
  Vector6d residual =
      Vector6d::Zero();  ///< innovation of the first component, along its noise axes
  Vector6d residual_variance = Vector6d::Ones();  ///< the variances expected of it

  Vector6d white_residual() const { return residual.cwiseQuotient(residual_variance.cwiseSqrt()); }
};

/// Updates a pair by a detection with the noise, clutter and symmetries of `sensor`.
/// `camera_gain_noise` multiplies the noise in the camera's gain; at infinity the camera does not
/// move.
PairUpdate observe(const Pair& pair, const SE3d& detected, const ObjectSensor& sensor,
                   double camera_gain_noise, GainCovariance gain_covariance);

}  // namespace posemix::internal
