// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/slam/association.hpp"
#include "posemix/slam/instance_tracks.hpp"

/// What is known after a frame.
namespace posemix {

using PoseDensity = ConcentratedGaussian<SE3d>;

/// What happened to one object in one frame.
enum class DetectionStatus {
  none,
  started,  ///< the object entered the map
  used,
  doubted,  ///< used, but more likely to be a gross error under the leading hypothesis
  birth,    ///< explained by no hypothesis, it began one
  gated,
  failed
};

/// The words of DetectionStatus in traces, in the order of the values.
template <>
inline constexpr WordTable<DetectionStatus, 7> words<DetectionStatus>{{
    {"none", DetectionStatus::none},
    {"started", DetectionStatus::started},
    {"used", DetectionStatus::used},
    {"doubted", DetectionStatus::doubted},
    {"birth", DetectionStatus::birth},
    {"gated", DetectionStatus::gated},
    {"failed", DetectionStatus::failed},
}};

/// What became of a candidate.
struct CandidateReport {
  CandidateStatus status = CandidateStatus::rejected;
  std::optional<std::size_t> object = {};  ///< the model that took it, where assigned or fresh
  bool recycled = false;                   ///< another instance was forgotten for it
};

/// Report of one frame.
struct FrameReport {
  std::vector<DetectionStatus> statuses = {};    ///< one per object model
  std::vector<CandidateReport> candidates = {};  ///< one per candidate
  /// One per observation; those that name their object are assigned, or fresh where they are the
  /// first of it.
  std::vector<CandidateReport> observations = {};
  /// One per object model: squared Mahalanobis distance z^T S^-1 z of the innovation of its last
  /// detection, of six degrees of freedom (fewer with symmetries about axes), by the leading
  /// hypothesis under the noise's first component (multi-object tracker), or by the heaviest one
  /// under the component that explains it best (Gaussian-sum filter). Empty where the tracker has
  /// none.
  std::vector<std::optional<double>> nis = {};
  UpdateReport update = {};
  std::size_t merges = 0;
  double seconds = 0.0;  ///< predict, update, reduce and summarise
};

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

/// The twist of an object about its origin, along the world's axes: turning rate [rad/s] and
/// velocity [m/s]. Zero for models of motion without.
struct ObjectTwist {
  Vector6d mean;
  Matrix6d covariance;
};

/// Ids of the object models in their order, shared by all estimates of one tracker.
using ObjectIds = std::shared_ptr<const std::vector<std::string>>;

/// The estimate of one object at one frame.
struct ObjectEstimate {
  std::optional<PoseDensity> world = {};        ///< T_world_object; empty until the object was seen
  std::optional<PoseDensity> relative;          ///< T_camera_object, with the cross-covariance
  std::optional<double> mode_probability = {};  ///< that the estimate is on the right mode
  std::optional<double> existence = {};         ///< probability that there is such an object
  TrackHealth health = TrackHealth::none;
  bool register_again = false;                       ///< lost or inconsistent for some time
  std::vector<ObjectAlternative> alternatives = {};  ///< where they are recorded
  DetectionStatus status = DetectionStatus::none;
  std::vector<double> motion_models = {};  ///< of an object that moves: probability of each model
  std::optional<ObjectTwist> twist = {};   ///< of an object that moves
};

/// The estimates of one frame, by the index of the object model or by its id. Objects that were not
/// seen so far are empty.
struct FrameEstimate {
  PoseDensity camera;                                ///< T_world_camera
  std::vector<std::optional<PoseDensity>> objects;   ///< T_world_object
  std::vector<std::optional<PoseDensity>> relative;  ///< T_camera_object, with the cross-covariance
  std::vector<std::optional<std::size_t>> pose_indices;
  std::vector<HypothesisSnapshot> hypotheses = {};  ///< over all poses; where they are recorded
  /// Of every object, by the multi-object tracker; where they are recorded.
  std::vector<std::vector<ObjectAlternative>> alternatives = {};
  /// Probability that the estimate is on the right mode, by the multi-object tracker.
  std::vector<std::optional<double>> mode_probabilities = {};
  /// Probability that the object exists, by the multi-object tracker (docs/existence.md).
  std::vector<std::optional<double>> existences = {};
  /// State of the track of every object, by the multi-object tracker.
  std::vector<TrackHealth> healths = {};
  /// Whether the track is lost or inconsistent for HealthSettings::register_again_s.
  std::vector<bool> register_again = {};
  FrameReport report = {};
  ObjectIds ids = {};
  /// Probability of each of its models of motion, by the multi-object tracker; empty for objects
  /// of the joint Gaussian, and those that were not seen so far.
  std::vector<std::vector<double>> motion_models = {};
  /// Of the same objects, at the most probable place.
  std::vector<std::optional<ObjectTwist>> twists = {};

  /// Index of the object model with this id.
  /// @throws InvalidInput for another id, with those that there are
  std::size_t index_of(std::string_view id) const;

  /// The estimate of the object with this id.
  /// @throws InvalidInput for another id, with those that there are
  ObjectEstimate object(std::string_view id) const;
};

}  // namespace posemix
