// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/slam/association.hpp"

/// Object SLAM, live: one call per frame.
namespace posemix {

/// The error of detectors of single images, where nothing better is known: rotation about the
/// camera's axes 7.5 deg and about the viewing ray 2 deg, translation 0.7 % of the range across the
/// ray and 4.5 % along it; a second component 2.7 times as wide; and clutter. Errors along the ray
/// have most in common, so a frame teaches the range twelve times less. docs/many-objects.md says
/// where the numbers are from.
DetectorNoise default_detector_noise();

/// How the camera is predicted.
enum class MotionModel {
  odometry,     ///< where odometry is missing for a frame: a random walk with the `unknown_motion`
                ///< noise
  random_walk,  ///< the mean stays
  constant_velocity  ///< the motion per period is part of the state
};

/// How a covariance grows with time.
enum class NoisePer { frame, second };

/// Noise of a motion: covariance (right perturbation, camera frame) per frame or per second.
struct ProcessNoise {
  Matrix6d covariance = Matrix6d::Identity();
  NoisePer per = NoisePer::second;

  /// Covariance of one step of `dt` seconds.
  Matrix6d over(double dt) const {
    return per == NoisePer::frame ? covariance : Matrix6d(dt * covariance);
  }
};

/// Settings of the motion model. Standard deviations below are per square root of a second.
struct MotionSettings {
  MotionModel model = MotionModel::odometry;
  /// Noise of the odometry, or of the pose under constant velocity: 0.15 deg, 2 mm.
  ProcessNoise noise{
      pose_covariance(Eigen::Vector3d::Constant(radians(0.15)), Eigen::Vector3d::Constant(2e-3))};
  /// Noise of the random walk, a camera held by hand: 1.65 deg, 27 mm.
  ProcessNoise walk{
      pose_covariance(Eigen::Vector3d::Constant(radians(1.65)), Eigen::Vector3d::Constant(27e-3))};
  /// Noise of the motion per period under constant velocity: 1 deg, 1 cm.
  ProcessNoise motion_noise{
      pose_covariance(Eigen::Vector3d::Constant(radians(1.0)), Eigen::Vector3d::Constant(1e-2))};
  /// Noise of a frame without odometry: 30 deg, 0.3 m.
  ProcessNoise unknown_motion{
      pose_covariance(Eigen::Vector3d::Constant(radians(30.0)), Eigen::Vector3d::Constant(0.3))};
  double period_s = 0.1;  ///< reference period of the constant-velocity motion
};

/// One object as the tracker knows it.
struct ObjectModel {
  std::string id;
  DetectorNoise noise = default_detector_noise();
  /// Covariance (world frame) with which the object starts independently of everything else. Empty,
  /// the default: it starts from its first detection with the detector's noise and its full
  /// cross-covariance.
  std::optional<Matrix6d> independent_start = {};
  /// Motions of the object's frame that no detector can tell; for the multi-object filter.
  SymmetryGroup symmetries = {};
  /// Objects that no detector can tell apart share a class; FrameInput::candidates are of classes.
  /// They are alike: noise and symmetries of a class are those of its first model. Empty: the
  /// object is a class of its own, named as its id.
  std::string class_id = {};
};

/// The filter behind object SLAM.
enum class SlamFilter {
  multi_object,  ///< MultiObjectFilter: births, clutter, hypotheses of every object for itself
  gaussian_sum   ///< GaussianSumFilter: hypotheses over all poses (midway-merge paper)
};

/// Settings of object SLAM.
struct ObjectSlamSettings {
  SlamFilter kind = SlamFilter::multi_object;
  MultiObjectSettings multi_object;  ///< has_odometry follows from the motion model
  GaussianSumSettings filter;        ///< of SlamFilter::gaussian_sum
  MotionSettings motion;
  AssociationSettings association;  ///< of candidates; for the multi-object filter
  /// An instance with fewer detections is tentative: its model is used again where a candidate
  /// begins a new instance of the class and no model is free.
  std::size_t confirming_detections = 3;
};

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

/// Input of one frame.
struct FrameInput {
  double dt = 0.0;                              ///< seconds since the last frame
  std::optional<SE3d> odometry;                 ///< T_camera(k-1)_camera(k)
  std::vector<std::optional<SE3d>> detections;  ///< T_camera_object, one entry per object model
  /// Detections that name a class, for the multi-object filter; each is of one instance at most.
  std::vector<Candidate> candidates = {};
};

/// What became of a candidate.
struct CandidateReport {
  CandidateStatus status = CandidateStatus::rejected;
  std::optional<std::size_t> object = {};  ///< the model that took it, where assigned or fresh
  bool recycled = false;                   ///< another instance was forgotten for it
};

/// Report of one frame.
struct FrameReport {
  std::vector<DetectionStatus> statuses;    ///< one per object model
  std::vector<CandidateReport> candidates;  ///< one per candidate
  UpdateReport update;
  std::size_t merges = 0;
  double seconds = 0.0;  ///< predict, update, reduce and summarise
};

/// Camera and objects, estimated live.
///
/// A frame is predict -> update -> reduce -> summarise; objects seen for the first time, at any
/// frame, enter after the update. Frames without detections or without odometry are valid.
class ObjectSlam {
 public:
  /// `camera` is the prior of T_world_camera at the first frame.
  ObjectSlam(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectModel> objects,
             const ObjectSlamSettings& settings);

  /// The first frame: detections only, nothing moves. Every later frame: `step`.
  ///
  /// Candidates are associated class by class (posemix::associate), after the detections: those of
  /// a known instance update it; those of none take the next free model of the class, or that of
  /// the tentative instance that was not seen for longest.
  /// @throws InvalidInput when the number of detections is not that of the object models, dt is not
  /// positive, or the Gaussian-sum filter gets candidates
  FrameReport start(const std::vector<std::optional<SE3d>>& detections,
                    const std::vector<Candidate>& candidates = {});
  FrameReport step(const FrameInput& input);

  /// The joint posterior; of the multi-object filter camera and leading hypotheses.
  Posterior posterior() const;
  /// One Gaussian for all poses, by the summary of the settings.
  const Hypothesis& estimate() const { return estimate_; }
  /// Index of the object's pose in every hypothesis; empty until it was seen.
  std::optional<std::size_t> pose_index(std::size_t object) const;
  /// The multi-object filter where it is the one behind this, else nothing.
  const MultiObjectFilter* multi_object() const { return std::get_if<MultiObjectFilter>(&filter_); }
  const std::vector<ObjectModel>& objects() const { return objects_; }
  /// Detections that made the object what it is, candidates included; zero again when another
  /// instance takes its model.
  std::size_t detections(std::size_t object) const { return sightings_[object].count; }

 private:
  void predict(GaussianSumFilter& filter, const FrameInput& input) const;
  void predict(MultiObjectFilter& filter, const FrameInput& input) const;
  FrameReport observe(const std::vector<std::optional<SE3d>>& detections,
                      const std::vector<Candidate>& candidates);
  void observe(GaussianSumFilter& filter, const std::vector<std::optional<SE3d>>& detections,
               FrameReport& report);
  void observe(MultiObjectFilter& filter, const std::vector<std::optional<SE3d>>& detections,
               FrameReport& report);
  void update(MultiObjectFilter& filter, std::size_t object, const SE3d& detected,
              FrameReport& report);
  void observe_candidates(MultiObjectFilter& filter, const std::vector<Candidate>& candidates,
                          FrameReport& report);
  void observe_class(MultiObjectFilter& filter, const std::vector<std::size_t>& models,
                     const std::vector<Candidate>& candidates,
                     const std::vector<std::size_t>& members, FrameReport& report);
  /// T_camera_object of the leading hypothesis, at most as uncertain as by one detection.
  ConcentratedGaussian<SE3d> predicted_instance(const MultiObjectFilter& filter,
                                                std::size_t object) const;
  CandidateReport new_instance(MultiObjectFilter& filter, const std::vector<std::size_t>& models);

  /// When and how often an object was seen.
  struct Sightings {
    std::size_t count = 0;
    std::size_t last_frame = 0;
  };

  std::vector<ObjectModel> objects_;
  MotionSettings motion_;
  std::variant<GaussianSumFilter, MultiObjectFilter> filter_;
  std::vector<std::optional<std::size_t>> indices_;
  AssociationSettings association_;
  std::size_t confirming_detections_;
  double birth_covariance_factor_;
  std::vector<Sightings> sightings_;
  std::size_t frame_ = 0;
  Hypothesis estimate_;
};

}  // namespace posemix
