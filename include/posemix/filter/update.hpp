// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/detector_noise.hpp"

/// The invariant extended Kalman filter on one hypothesis over the camera T_R and the objects T_j,
/// X = Exp(xi) X0 pose by pose.
namespace posemix {

/// A hypothesis over all poses: pose 0 is the camera.
using Hypothesis = ConcentratedGaussian<PoseStackd>;

inline constexpr std::size_t kCamera = 0;

/// One detection of an object.
struct Detection {
  std::size_t object;  ///< index of its pose in the stack
  SE3d camera_object;  ///< the detected T_camera_object, Y in the midway-merge paper, eq. 32
  const DetectorNoise* noise;  ///< not null
};

/// The innovation of one detection under one noise component, in the world frame. With
///   z = Log(T_R Y offset^-1 T_o^-1)
/// the model is z = xi_o - xi_R + noise, so H = [-I I] whatever the poses are.
struct Innovation {
  Vector6d residual;  ///< z
  Matrix6d noise;     ///< covariance of the noise
};

/// The innovation at given poses.
Innovation innovation(const PoseStackd& mean, const Detection& detection,
                      const NoiseComponent& noise);

/// Squared Mahalanobis distance z^T S^-1 z of one detection from one hypothesis; chi-square with
/// six degrees of freedom when the hypothesis and the component are right. Infinite when S is
/// numerically not positive definite.
double squared_mahalanobis(const Hypothesis& hypothesis, const Detection& detection,
                           const NoiseComponent& noise);

/// Result of `update`.
struct UpdateResult {
  Hypothesis posterior;
  double log_likelihood;  ///< log N(z; 0, S) [nats]
  bool ok;  ///< false: S is numerically not positive definite, the posterior is the prior and the
            ///< likelihood -inf
};

/// Updates one hypothesis with several detections at once, each under the noise component given for
/// it. The covariance is computed in Joseph's form where the prior is far wider than the noise.
/// @throws InvalidInput when there are not as many components as detections
UpdateResult update(const Hypothesis& prior, std::span<const Detection> detections,
                    std::span<const NoiseComponent* const> noise);

/// The hypothesis with one more pose at the end: an object detected at `camera_object`, Y, under
/// one noise component. T_o = T_R Y offset^-1, P_oo = P_RR + R, P_o* = P_R*: the new object is as
/// correlated with all poses as the camera is.
Hypothesis with_detected_object(const Hypothesis& prior, const SE3d& camera_object,
                                const NoiseComponent& noise);

/// The hypothesis with one more pose at the end, whose error is independent of all others.
Hypothesis with_independent_pose(const Hypothesis& prior, const SE3d& mean,
                                 const Matrix6d& covariance);

}  // namespace posemix
