// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "object_hypotheses.hpp"
#include "posemix/filter/update.hpp"

/// What a MultiObjectFilter holds, and what it does with a detection. In the room `filter` only.
namespace posemix {

class MultiObjectFilter::State {
 public:
  using ObjectState = internal::ObjectState;
  using PairUpdate = internal::PairUpdate;

  State(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectSensor> sensors,
        const MultiObjectSettings& given);

  ObjectUpdateReport update(std::size_t j, const SE3d& detected);
  void forget(std::size_t j);

  void pass(double dt) {
    now_s += dt;
    frame_s = dt;
  }

  double correlation_length() const;
  /// Of the filter's covariances, to be those of the true error. Until the first detection they
  /// are.
  double factor() const { return settings.has_odometry ? correlation_length() : 1.0; }
  /// Of the hypotheses of an object, w^(1 / dependent) normalised with that of absence.
  std::vector<double> probabilities(const ObjectState& object) const;
  /// What all detections of an object have in common, in the world frame.
  Matrix6d bias_covariance(const ObjectState& object, const SE3d& camera, const SE3d& pose) const;
  Matrix6d bias_covariance(const ObjectState& object, const SE3d& pose) const {
    return bias_covariance(object, joint.pose(kCamera), pose);
  }
  /// Camera and one hypothesis with the covariance of the true error.
  internal::Pair inflated_pair(const ObjectState& object, std::size_t h) const;

  MultiObjectSettings settings;
  double explained;
  internal::MergeBounds merge_bounds;
  internal::JointGaussian joint;
  std::vector<ObjectState> objects;
  double now_s = 0.0;
  double frame_s = 0.1;               ///< between the last two frames
  std::optional<std::size_t> motion;  ///< index of the camera's motion in the joint Gaussian
  std::uint64_t next_id = 0;
  Matrix6d drift = Matrix6d::Zero();  ///< of the map, in the world frame

 private:
  void begin(ObjectState& object);
  void walk(ObjectState& object);
  std::vector<PairUpdate> observe(const ObjectState& object, const SE3d& detected) const;
  void learn(ObjectState& object, const PairUpdate& leader, ObjectUpdateReport& report) const;
  void learn_scale(ObjectState& object, const PairUpdate& update) const;
  std::vector<ObjectHypothesis> births_of(const ObjectState& object, const SE3d& detected);
  double weigh(ObjectState& object, const std::vector<PairUpdate>& updates,
               const std::vector<ObjectHypothesis>& births) const;
  void move_camera(ObjectState& object, const std::vector<PairUpdate>& updates, double log_evidence,
                   std::vector<ObjectHypothesis>& births);
  std::size_t settle(ObjectState& object, std::vector<ObjectHypothesis> births);
};

}  // namespace posemix
