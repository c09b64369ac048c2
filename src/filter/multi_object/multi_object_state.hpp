// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "noise_scale.hpp"
#include "object_belief.hpp"

namespace posemix::internal {

/// One object of a MultiObjectFilter.
struct TrackedObject {
  LearnedSensor detector;
  ObjectBelief belief = {};
};

/// The state of a MultiObjectFilter, and its change by a detection.
struct MultiObjectState {
  MultiObjectState(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectSensor> sensors,
                   const MultiObjectSettings& settings);

  /// One detection T_camera_object of object `j`.
  ObjectUpdateReport update(std::size_t j, const SE3d& detected);
  /// Object `j` becomes one that was never detected.
  void forget(std::size_t j);
  /// Time goes on by one frame, in which the camera moved from `camera_before` where that is known.
  void advance(double dt, const std::optional<SE3d>& camera_before);

  /// A hypothesis of an object as it is reported: with the error that all detections have in common
  /// and any angle about an axis of symmetry.
  DetectionState reported(const TrackedObject& object, std::size_t h) const;
  /// What a report adds to the covariance of an object at `pose`, world frame.
  static Matrix6d unseen_covariance(const TrackedObject& object, const SE3d& pose);
  /// Whether the gain of a detection of the object is damped: with odometry, for a detector of
  /// which only what is typical is known.
  bool is_damped(const TrackedObject& object) const {
    return settings.has_odometry && object.detector.sensor().noise.dependence().is_typical;
  }
  GainFactors gain_factors(const TrackedObject& object) const;

  MultiObjectSettings settings;
  double explained;  ///< squared Mahalanobis distance within which a detection is explained
  MergeBounds merge_bounds;
  JointGaussian joint;
  std::vector<TrackedObject> objects;
  double now_s = 0.0;
  std::optional<std::size_t> motion;  ///< index of the camera's motion in the joint Gaussian
  std::uint64_t next_id = 0;

 private:
  void update_weights(TrackedObject& object, const std::vector<DetectionUpdate>& updates,
                      double share) const;
  std::vector<Alternative> births_of(const TrackedObject& object, const SE3d& detected,
                                     const std::vector<DetectionUpdate>& updates, double share);
  void learn(TrackedObject& object, const DetectionUpdate& leading);
  void move_poses(TrackedObject& object, const std::vector<DetectionUpdate>& updates,
                  double log_evidence, std::vector<Alternative>& births);
  void shift_back(const TrackedObject& detected, const CameraChange& change,
                  std::vector<Alternative>& births);
  std::size_t reduce(TrackedObject& object);
};

}  // namespace posemix::internal
