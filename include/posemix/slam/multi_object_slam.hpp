// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/tracker.hpp"

namespace posemix {

/// Settings of MultiObjectSlam.
struct MultiObjectSlamSettings {
  MultiObjectSettings filter = {};       ///< has_odometry follows from the motion model
  AssociationSettings association = {};  ///< of candidates
  /// An instance with fewer detections is tentative: its model is used again where a candidate
  /// begins a new instance of the class and no model is free.
  std::size_t confirming_detections = 3;
};

/// Object SLAM by the MultiObjectFilter: hypotheses of every object for itself, clutter, births.
///
/// Candidates are associated class by class (posemix::associate), after the detections: those of a
/// known instance update it; those of none take the next free model of the class, or that of the
/// tentative instance that was not seen for longest. Satisfies ObjectTracker.
class MultiObjectSlam {
 public:
  /// `camera` is the prior of T_world_camera at the first frame. Where hypotheses are recorded, an
  /// estimate holds the alternatives of every object.
  /// @throws InvalidInput when a setting is out of range, two models share an id, two models of one
  /// class differ in noise or symmetries, or a model has an independent start
  MultiObjectSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                  const MultiObjectSlamSettings& settings = {}, const MotionSettings& motion = {},
                  bool record_hypotheses = false);

  FrameEstimate step(const FrameInput& input);

  /// Camera and leading hypotheses.
  Posterior posterior() const { return Posterior({{0.0, estimate()}}); }
  /// Made when it is asked for, which is quadratic in the objects. The reference holds until the
  /// next step.
  const Hypothesis& estimate() const { return filter_.current_joint(); }
  std::optional<std::size_t> pose_index(std::size_t object) const {
    return filter_.pose_index(object);
  }
  const std::vector<ObjectModel>& objects() const { return objects_.models(); }
  /// Detections that made the object what it is, candidates included; zero again when another
  /// instance takes its model.
  std::size_t detections(std::size_t object) const {
    objects_.require(object);
    return sightings_[object].count;
  }
  const MultiObjectFilter& filter() const { return filter_; }

 private:
  void update(std::size_t object, const SE3d& detected, FrameReport& report);
  void update_by_candidates(const std::vector<Candidate>& candidates, FrameReport& report);
  void update_class(const std::vector<std::size_t>& models,
                    const std::vector<Candidate>& candidates,
                    const std::vector<std::size_t>& members, FrameReport& report);
  CandidateReport new_instance(const std::vector<std::size_t>& models);
  FrameEstimate frame_estimate(FrameReport report) const;

  /// When and how often an object was seen.
  struct Sightings {
    std::size_t count = 0;
    std::size_t last_frame = 0;
  };

  TrackedObjects objects_;
  MultiObjectSlamSettings settings_;
  MotionSettings motion_;
  bool record_hypotheses_;
  MultiObjectFilter filter_;
  std::vector<Sightings> sightings_;
};

static_assert(ObjectTracker<MultiObjectSlam>);

}  // namespace posemix
