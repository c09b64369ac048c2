// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "learned_sensor.hpp"
#include "object_belief.hpp"

namespace posemix::internal {

/// One object of a MultiObjectFilter.
struct TrackedObject {
  LearnedSensor detector;
  ObjectBelief belief = {};
  Matrix6d drift = Matrix6d::Zero();  ///< the map's drift up to the object's last detection
};

/// The state of a MultiObjectFilter, and its change by a detection.
struct MultiObjectState {
  MultiObjectState(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectSensor> sensors,
                   const MultiObjectSettings& settings);

  /// One detection T_camera_object of object `j`.
  ObjectUpdateReport update(std::size_t j, const SE3d& detected);
  /// Object `j` becomes one that was never detected.
  void forget(std::size_t j);
  /// Time goes on by one frame.
  void advance(double dt);

  /// The mean correlation length over all objects with detections; 1 without.
  double correlation_length() const;
  /// Factor from the filter's covariances, which count every detection as independent, to those of
  /// the true error. One before the first detection.
  double covariance_factor() const { return settings.has_odometry ? correlation_length() : 1.0; }
  /// Probabilities of the hypotheses of an object, with dependent detections counted once.
  std::vector<double> probabilities(const TrackedObject& object) const;
  /// The camera and one hypothesis with the covariance of the true error.
  Pair inflated_pair(const TrackedObject& object, std::size_t h) const;

  MultiObjectSettings settings;
  double explained;  ///< squared Mahalanobis distance within which a detection is explained
  MergeBounds merge_bounds;
  JointGaussian joint;
  std::vector<TrackedObject> objects;
  double now_s = 0.0;
  double frame_s = 0.1;               ///< time between the last two frames
  std::optional<std::size_t> motion;  ///< index of the camera's motion in the joint Gaussian
  std::uint64_t next_id = 0;
  Matrix6d drift = Matrix6d::Zero();  ///< of the map since the start, along an object's own axes

 private:
  std::uint64_t detections() const;
  void count_detection(TrackedObject& object);
  std::vector<PairUpdate> update_pairs(const TrackedObject& object, const SE3d& detected) const;
  void update_weights(TrackedObject& object, const std::vector<PairUpdate>& updates) const;
  std::vector<Alternative> births_of(const TrackedObject& object, const SE3d& detected,
                                     const std::vector<PairUpdate>& updates);
  void add_process_noise(TrackedObject& object);
  void move_poses(TrackedObject& object, const std::vector<PairUpdate>& updates,
                  double log_evidence, std::vector<Alternative>& births);
  std::size_t reduce(TrackedObject& object);
};

}  // namespace posemix::internal
