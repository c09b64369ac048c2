// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "posemix/slam/gaussian_sum_slam.hpp"
#include "posemix/slam/multi_object_slam.hpp"
#include "posemix/slam/particle_slam.hpp"

/// Object SLAM, live: one call per frame.
namespace posemix {

/// The tracker, chosen by its settings.
using TrackerSettings =
    std::variant<MultiObjectSlamSettings, GaussianSumSettings, ParticleFilterSettings>;

/// Settings of object SLAM; posemix::slam_methods has a table of well-known ones.
struct ObjectSlamSettings {
  MotionSettings motion = {};
  TrackerSettings tracker = {};
  /// Whether every estimate holds the hypotheses: the alternatives of every object, or hypotheses
  /// over all poses.
  bool record_hypotheses = false;
};

/// Camera and objects, estimated live by the tracker of the settings. Satisfies ObjectTracker.
///
///     ObjectSlam slam(camera, {{.id = "mug"}, {.id = "box"}});
///     FrameEstimate e = slam.step({.dt = 0.1, .motion = u, .detections = {T_camera_mug, {}}});
///     e.object("mug").world;  // T_world_mug with its covariance
class ObjectSlam {
 public:
  using Tracker = std::variant<MultiObjectSlam, GaussianSumSlam, ParticleSlam>;

  /// `camera` is the prior of T_world_camera at the first frame.
  /// @throws InvalidInput as the tracker
  ObjectSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
             const ObjectSlamSettings& settings = {});
  /// Goes on with a tracker, such as one that was loaded.
  explicit ObjectSlam(Tracker tracker) : tracker_(std::move(tracker)) {}

  /// The next frame; at the first one nothing moves.
  /// @throws InvalidInput, and changes nothing, when the number of detections is not that of the
  /// object models, dt is not in (0, kLatestStamp] after the first frame, as check_pose for the
  /// motion, a detection and a candidate, or when a tracker without births gets candidates
  FrameEstimate step(const FrameInput& input);
  /// The object is as if it had never been seen (MultiObjectSlam::forget).
  /// @throws InvalidInput when there is no object at the index, and for a tracker that is not
  /// MultiObjectSlam
  void forget(std::size_t object);

  Posterior posterior() const;
  const Hypothesis& estimate() const;
  /// @throws InvalidInput when there is no object at the index; `detections` too
  std::optional<std::size_t> pose_index(std::size_t object) const;
  const std::vector<ObjectModel>& objects() const;
  std::size_t detections(std::size_t object) const;

  const Tracker& tracker() const { return tracker_; }
  /// The multi-object filter where it is behind the tracker, else nothing.
  const MultiObjectFilter* multi_object() const;

 private:
  Tracker tracker_;
};

static_assert(ObjectTracker<ObjectSlam>);

}  // namespace posemix
