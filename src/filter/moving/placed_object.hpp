// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "filter/multi_object/detection_update.hpp"
#include "posemix/filter/moving_object_filter.hpp"

/// One Gaussian for the pose of a moving object, and what is done with it.
namespace posemix::internal {

/// Rows of the twist and the slow error in the Gaussian; the pose comes first.
inline constexpr Eigen::Index kTwistRow = 6;
inline constexpr Eigen::Index kLastSlowRow = 12;

/// Pose, twist and slow error of the detector under one hypothesis and one motion model, with the
/// Gaussian of [xi; beta; b]. Rows of a twist or of a slow error that there is not are zero.
struct PlacedObject {
  SE3d pose;                          ///< T_world_object
  Vector6d twist = Vector6d::Zero();  ///< in the frame of the model
  Vector6d slow = Vector6d::Zero();   ///< mean of b, in the frame and units of the noise
  Matrix18d covariance = Matrix18d::Zero();

  Matrix6d pose_covariance() const { return covariance.topLeftCorner<6, 6>(); }
  MotionState motion_state() const { return {pose, twist, covariance.topLeftCorner<12, 12>()}; }
  /// The state as a detection sees it, from a camera whose error in one image has a covariance.
  DetectionState seen_from(const KnownFrame& camera) const;
  /// Pose and twist become those of `state`, which they reach by the Jacobian.
  void set_motion(const MotionState& state, const Matrix12d& jacobian);
  /// Moves the mean.
  void move(const Vector18d& by);
  /// x <- F x about the mean, where the means of twist and slow error move with it or not.
  void transform(const Matrix18d& f);
  /// The mean from another, in the tangent space there.
  Vector18d from(const PlacedObject& other) const;
  /// The covariance in the tangent space at a pose from which this one is the `distance`, eq. 14 of
  /// the midway-merge paper.
  Matrix18d transported(const Vector6d& distance) const;
};

/// A Gaussian and its weight in a mixture.
struct WeightedObject {
  double weight;
  const PlacedObject* object;
};

/// Moments of a mixture of Gaussians that lie near each other, by the midway rule
/// (midway-merge paper, eq. 12 to 18): every one is moved to the tangent space at the weighted
/// mean. The weights need not be normalised.
PlacedObject mixed(std::span<const WeightedObject> parts);

/// b <- a b + w with Cov w = (1 - a^2) B.
void decay_slow(PlacedObject& object, double correlation, const Matrix6d& stationary);

/// b <- f b and xi <- xi + A (1 - f) b, as ObjectBelief::rescale_slow_error. Returns the Jacobian.
Matrix18d rescale_slow(PlacedObject& object, const ObjectSensor& sensor, const KnownFrame& camera,
                       const Vector6d& factor);

/// The directions in which the symmetries leave the pose free become independent of
/// everything, with a small variance.
void fix_unobserved(PlacedObject& object, const SymmetryGroup& symmetries,
                    const ObjectMotion& motion);

/// Mean and covariance of the twist along the world's axes.
struct WorldTwist {
  Vector6d mean;
  Matrix6d covariance;
};
WorldTwist world_twist(const PlacedObject& object, const ObjectMotion& motion);

}  // namespace posemix::internal
