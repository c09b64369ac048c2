// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "filter/world_shift.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "slam/mode_smoother.hpp"

/// Frames to be smoothed, between what the filter knew and what it knows. In the room `slam` only.
namespace posemix::internal {

/// One hypothesis of every object by its index, none for an object that has none.
using Modes = std::vector<std::optional<std::size_t>>;

Modes leading_modes(const MultiObjectFilter& filter);

/// A window as it is smoothed on one mode of every object.
struct SmoothedModes {
  /// Camera, its motion under constant velocity, then the objects that have a mode, and their slow
  /// errors.
  std::vector<JointState> states;
  std::vector<Matrix6d> camera_lags;  ///< ModeSmoother::camera_lags
};

/// The window on one mode of every object: `before` is the filter before its first frame, `now`
/// after its last; `modes` are hypotheses of now. All that was learned of the noise is of now.
class SmoothingWindow {
 public:
  /// `scene` is where the camera is at the first frame, about.
  SmoothingWindow(const MultiObjectFilter& before, const MultiObjectFilter& now,
                  const MotionSettings& motion, const SE3d& scene, const Modes& modes);

  SmoothedModes smooth(std::span<const SmootherFrame* const> frames, std::size_t passes) const;

  /// The density of the poses as it is reported, see MultiObjectFilter::unseen_covariance.
  Hypothesis reported(const JointState& joint) const;

  /// An object that the filter did not have, so far from the first camera that in the passes after
  /// the first one its errors would be lost beside what is not known of it. None for one pass.
  std::optional<std::size_t> too_far(std::span<const SmootherFrame* const> frames,
                                     std::size_t passes) const;

  /// Of the object's pose in what is smoothed.
  std::optional<std::size_t> pose_index(std::size_t object) const { return indices_[object]; }

 private:
  /// What the filter had before the window, near the scene.
  struct Given {
    JointState joint;
    bool has_motion;
  };

  double least_variance(std::size_t object, std::span<const SmootherFrame* const> frames) const;
  Modes known_before() const;
  Given given_before(const ModeModel& model, const Modes& known) const;
  JointState start(const ModeModel& model, const Modes& known, bool vague) const;
  /// Poses of the world are moved to another.
  JointState moved(JointState joint, const std::vector<std::size_t>& in_world,
                   const WorldShift& shift) const;
  /// Camera and objects of what is smoothed, without the motion.
  std::vector<std::size_t> poses_in_world() const;
  void add_new(const ModeModel& model, std::size_t i, bool vague, JointState& start) const;
  Matrix6d new_covariance(std::size_t i, bool vague) const;

  const MultiObjectFilter& before_;
  const MultiObjectFilter& now_;
  /// From the world of the filter to that in which the window is smoothed, whose origin is near the
  /// first camera: what was seen there stays as it is when the camera goes far.
  WorldShift to_scene_;
  ModeModel model_;
  std::vector<ObjectHypothesis> hypotheses_;  ///< of now, by object of the model, near the scene
  std::vector<std::optional<std::size_t>> indices_;
};

}  // namespace posemix::internal
