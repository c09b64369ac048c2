// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "posemix/slam/run.hpp"

/// Estimates that also look ahead: from all detections of a recording, or from those of a few
/// frames more (docs/filter.md, smoothing).
namespace posemix {

namespace internal {
class SmoothingWindow;
}  // namespace internal

/// Settings of smoothing.
struct SmoothingSettings {
  /// Frames that an estimate looks ahead; 0: all, to the end of the recording.
  std::size_t lag_frames = 0;
  /// Forward and backward passes. The first is linearised where it predicts, each further one where
  /// the one before it ended, which also weighs the noise's components anew.
  std::size_t passes = 3;
  /// Hypotheses of an object with at least this probability are smoothed, where they are asked for
  /// (record_hypotheses); the leading one always is.
  double least_probability = 1e-3;
};

/// A frame as the filter took it.
struct SmootherFrame {
  FrameInput input = {};  ///< time and motion
  std::vector<ObservedObject> observed = {};
};

/// Object SLAM that reports each frame `lag_frames` later than it comes. The multi-object filter
/// runs up to the newest frame. Its leading hypotheses set the mode of every object for the whole
/// window, and the window is smoothed on these modes, by a forward filter and a Rauch-Tung-Striebel
/// pass that start from the filter's posterior before the window. Cost: linear in the lag, per
/// frame.
class FixedLagSmoother {
 public:
  /// @throws InvalidInput as ObjectSlam, when a setting is out of range, when the filter is not the
  /// multi-object one, and when it only considers the camera; `step` for candidates and
  /// observations of classes; for objects that are not declared (on_sight)
  FixedLagSmoother(const PoseDensity& camera, std::vector<ObjectModel> objects,
                   const ObjectSlamSettings& settings, const SmoothingSettings& smoothing,
                   bool record_hypotheses = false);

  /// As ObjectSlam::step; the estimate is that of the frame `lag_frames` earlier, if there is one.
  /// Its `report` is of the filter, its time that of both.
  std::optional<FrameEstimate> step(const FrameInput& input);

  /// The frames that are left, after the last one.
  std::vector<FrameEstimate> finish();

  /// The filter that runs ahead.
  const ObjectSlam& slam() const { return slam_; }
  /// Camera, its motion under constant velocity, and objects, at the last frame that was reported.
  const std::optional<Hypothesis>& joint() const { return joint_; }
  /// Of the frames of the window that was smoothed last, the covariance of the error of the
  /// camera's pose with that at the frame before (perturbations on the left, world frame); zero at
  /// the first.
  const std::vector<Matrix6d>& camera_lags() const { return camera_lags_; }

 private:
  struct Frame {
    SmootherFrame taken;
    FrameReport report;
    std::vector<bool> known;  ///< objects that were seen by then
    std::optional<MultiObjectFilter> after;
  };

  SE3d scene() const;
  std::vector<std::size_t> reported_poses(const internal::SmoothingWindow& window,
                                          std::size_t frame) const;
  /// @throws InvalidInput naming the object, or the frame, of which rounding leaves nothing
  void require_near(const internal::SmoothingWindow& window,
                    std::span<const SmootherFrame* const> frames) const;
  void require_sound(const internal::SmoothingWindow& window,
                     const std::vector<JointState>& joint) const;
  std::vector<FrameEstimate> smooth(std::size_t count);
  void add_alternatives(std::span<const SmootherFrame* const> frames,
                        const std::vector<JointState>& leading,
                        std::vector<FrameEstimate>& estimates) const;

  bool is_first_ = true;
  ObjectIds ids_;
  MotionSettings motion_;
  SmoothingSettings smoothing_;
  bool record_hypotheses_;
  ObjectSlam slam_;
  MultiObjectFilter before_;  ///< before the first frame of the window
  std::deque<Frame> window_;
  std::optional<Hypothesis> joint_;
  std::vector<Matrix6d> camera_lags_;
};

/// `run` with smoothed estimates. Objects are reported from the frame on in which they were first
/// detected, on the mode that leads in the end (for a lag: when the frame is reported), which may
/// not be the first one; mode_probabilities and probabilities are those of then. `alternatives` of
/// the frames hold the hypotheses of then, each smoothed in place of the leading one. The posterior
/// is the smoothed one of the last frame, in the order camera, motion, objects. Where objects move
/// or detections name classes the filter runs first, and `progress` counts the frames twice.
/// @throws InvalidInput as `run` and FixedLagSmoother
SlamRun run_smoothed(const Sequence& sequence, const PoseDensity& camera_prior,
                     const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
                     const SmoothingSettings& smoothing, const RunOptions& options = {});

}  // namespace posemix
