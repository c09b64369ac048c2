// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/tracker.hpp"

namespace posemix {

/// Object SLAM by the GaussianSumFilter: hypotheses over all poses (midway-merge paper). Satisfies
/// ObjectTracker.
class GaussianSumSlam {
 public:
  /// `camera` is the prior of T_world_camera at the first frame. Where hypotheses are recorded, an
  /// estimate holds all of them. `settings.first_object` follows from the motion model.
  /// @throws InvalidInput when a setting is out of range or two models share an id
  GaussianSumSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                  const GaussianSumSettings& settings = {}, const MotionSettings& motion = {},
                  bool record_hypotheses = false);

  /// @throws InvalidInput also for candidates: this filter has no births, and as
  /// GaussianSumFilter::update
  FrameEstimate step(const FrameInput& input);

  Posterior posterior() const { return filter_.posterior(); }
  /// One Gaussian in place of the posterior, by the `summary` of the settings.
  const Hypothesis& estimate() const { return estimate_; }
  std::optional<std::size_t> pose_index(std::size_t object) const {
    objects_.require(object);
    return indices_[object];
  }
  const std::vector<ObjectModel>& objects() const { return objects_.models(); }
  std::size_t detections(std::size_t object) const {
    objects_.require(object);
    return counts_[object];
  }
  const GaussianSumFilter& filter() const { return filter_; }

 private:
  using Detections = std::vector<std::optional<SE3d>>;

  /// The detections of objects that are in the map, and the indices of their models.
  struct KnownDetections {
    std::vector<Detection> detections;
    std::vector<std::size_t> objects;
  };

  KnownDetections known_of(const Detections& detections) const;
  void update_known(const KnownDetections& known, FrameReport& report);
  void add_new(const Detections& detections, FrameReport& report);

  TrackedObjects objects_;
  MotionSettings motion_;
  bool record_hypotheses_;
  GaussianSumFilter filter_;
  std::vector<std::optional<std::size_t>> indices_;
  std::vector<std::size_t> counts_;
  Hypothesis estimate_;
};

static_assert(ObjectTracker<GaussianSumSlam>);

}  // namespace posemix
