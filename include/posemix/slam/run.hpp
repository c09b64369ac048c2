// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/sequence.hpp"

/// Object SLAM over a whole recording.
namespace posemix {

using PoseDensity = ConcentratedGaussian<SE3d>;

/// One hypothesis of one frame: the log-weight and the mean pose of camera and objects.
struct HypothesisSnapshot {
  double log_weight;
  PoseStackd poses;
};

/// One alternative of one object at one frame.
struct ObjectAlternative {
  double probability;  ///< dependent detections counted once
  SE3d pose;           ///< T_world_object
  std::uint64_t id;    ///< the same from frame to frame
};

/// The causal estimates of one frame. Objects not seen so far are empty.
struct FrameEstimate {
  PoseDensity camera;                                ///< T_world_camera
  std::vector<std::optional<PoseDensity>> objects;   ///< T_world_object
  std::vector<std::optional<PoseDensity>> relative;  ///< T_camera_object, with the cross-covariance
  std::vector<std::optional<std::size_t>> pose_indices;
  std::vector<HypothesisSnapshot> hypotheses = {};  ///< over all poses; only when asked for
  /// Of every object, by the multi-object filter; only when asked for.
  std::vector<std::vector<ObjectAlternative>> alternatives = {};
  /// Probability that the estimate is on the right mode, by the multi-object filter.
  std::vector<std::optional<double>> mode_probabilities = {};
  FrameReport report;
};

/// A processed recording.
struct SlamRun {
  std::vector<FrameEstimate> frames;
  Posterior posterior;                                   ///< of the last frame
  std::vector<std::optional<std::size_t>> pose_indices;  ///< of the objects in the posterior
  /// Hypotheses of every object at the last frame, by the multi-object filter; the posterior holds
  /// those that lead.
  std::vector<std::vector<ObjectHypothesis>> alternatives = {};
};

/// Options of `run`.
struct RunOptions {
  bool record_hypotheses = false;
  /// Called after every frame with (frames done, frames in all); returning false stops the run.
  std::function<bool(std::size_t, std::size_t)> progress;
};

/// Runs object SLAM over a recording, one object model per object of the recording, in the same
/// order. Frames at which odometry is missing on either side count as frames without odometry. When
/// `progress` stops it, the frames done so far are returned.
/// @throws InvalidInput when the sequence is not valid or the models do not fit it
SlamRun run(const Sequence& sequence, const PoseDensity& camera_prior,
            const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
            const RunOptions& options = {});

/// The same models with one Gaussian of noise each, and settings with one hypothesis: the
/// right-invariant extended Kalman filter (RIEKF).
std::pair<std::vector<ObjectModel>, ObjectSlamSettings> as_riekf(std::vector<ObjectModel> models,
                                                                 ObjectSlamSettings settings);

/// Settings with one linearized hypothesis that uses for each detection the one noise component (or
/// clutter) of the largest weighted likelihood: the max-mixture of Olson and Agarwal (2013), as a
/// filter.
ObjectSlamSettings as_max_mixture(ObjectSlamSettings settings);

}  // namespace posemix
