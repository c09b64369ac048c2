// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/sequence.hpp"

/// Object SLAM over a whole recording.
namespace posemix {

/// A processed recording.
struct SlamRun {
  std::vector<FrameEstimate> frames;
  Posterior posterior;                                   ///< of the last frame
  std::vector<std::optional<std::size_t>> pose_indices;  ///< of the objects in the posterior
  /// Hypotheses of every object at the last frame, by the multi-object filter; the posterior holds
  /// those that lead.
  std::vector<std::vector<ObjectHypothesis>> hypotheses = {};
  /// The cameras of a rig as they are known at the last frame, by the multi-object filter.
  std::vector<BodyCamera> cameras = {};
};

/// Options of `run`.
struct RunOptions {
  bool record_hypotheses = false;
  /// Called after every frame with (frames done, frames in all); returning false stops the run.
  std::function<bool(std::size_t, std::size_t)> progress = {};
  /// Called by `run` with the tracker after the last frame, such as to save its state.
  std::function<void(const ObjectSlam&)> finished = {};
  /// Called with every estimate that the run will return, in their order, before it is kept, such
  /// as to move recorded hypotheses out of it, which need most of the memory of a long run.
  std::function<void(FrameEstimate&)> estimated = {};
};

/// Runs object SLAM over a recording, one object model per object of the recording, with the same
/// ids in the same order. Frames at which odometry is missing on either side count as frames
/// without odometry. When `progress` stops it, the frames done so far are returned.
/// @throws InvalidInput when the sequence is not valid or the models do not fit it
SlamRun run(const Sequence& sequence, const PoseDensity& camera_prior,
            const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
            const RunOptions& options = {});

}  // namespace posemix
