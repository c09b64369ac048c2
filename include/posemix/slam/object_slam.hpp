// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"

/// Object SLAM, live: one call per frame.
namespace posemix {

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
  /// Noise of the odometry, of the random walk, or of the pose under constant velocity: 0.15 deg, 2
  /// mm.
  ProcessNoise noise{
      pose_covariance(Eigen::Vector3d::Constant(radians(0.15)), Eigen::Vector3d::Constant(2e-3))};
  /// Noise of the motion per period under constant velocity: 1 deg, 1 cm.
  ProcessNoise motion_noise{
      pose_covariance(Eigen::Vector3d::Constant(radians(1.0)), Eigen::Vector3d::Constant(1e-2))};
  /// Noise of a frame without odometry: 30 deg, 0.3 m.
  ProcessNoise unknown_motion{
      pose_covariance(Eigen::Vector3d::Constant(radians(30.0)), Eigen::Vector3d::Constant(0.3))};
  double period_s = 0.1;  ///< reference period of the constant-velocity motion
};

/// A class of objects as the tracker knows it.
struct ObjectModel {
  std::string id;
  DetectorNoise noise;
  /// Covariance (world frame) with which the object starts independently of everything else. Empty,
  /// the default: it starts from its first detection with the detector's noise and its full
  /// cross-covariance.
  std::optional<Matrix6d> independent_start;
};

/// Settings of object SLAM.
struct ObjectSlamSettings {
  FilterSettings filter;
  MotionSettings motion;
};

/// What happened to one object in one frame.
enum class DetectionFate { none, started, used, gated, failed };

/// Input of one frame.
struct FrameInput {
  double dt = 0.0;                              ///< seconds since the last frame
  std::optional<SE3d> odometry;                 ///< T_camera(k-1)_camera(k)
  std::vector<std::optional<SE3d>> detections;  ///< T_camera_object, one entry per object model
};

/// Report of one frame.
struct FrameReport {
  std::vector<DetectionFate> fates;  ///< one per object model
  UpdateReport update;
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
  /// @throws InvalidInput when the number of detections is not that of the object models, or dt is
  /// not positive
  FrameReport start(const std::vector<std::optional<SE3d>>& detections);
  FrameReport step(const FrameInput& input);

  const Posterior& posterior() const { return filter_.posterior(); }
  /// One Gaussian for all poses, by the summary of the settings.
  const Hypothesis& estimate() const { return estimate_; }
  /// Index of the object's pose in every hypothesis; empty until it was seen.
  std::optional<std::size_t> pose_index(std::size_t object) const { return indices_[object]; }
  const std::vector<std::optional<std::size_t>>& pose_indices() const { return indices_; }
  const std::vector<ObjectModel>& objects() const { return objects_; }

 private:
  void predict(const FrameInput& input);
  FrameReport observe(const std::vector<std::optional<SE3d>>& detections);

  std::vector<ObjectModel> objects_;
  MotionSettings motion_;
  GaussianSumFilter filter_;
  std::vector<std::optional<std::size_t>> indices_;
  Hypothesis estimate_;
};

}  // namespace posemix
