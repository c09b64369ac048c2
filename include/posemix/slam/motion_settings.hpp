// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/units.hpp"
#include "posemix/base/words.hpp"
#include "posemix/detector/detector_noise.hpp"

/// How the camera moves from frame to frame.
namespace posemix {

/// How the camera is predicted.
enum class MotionModel {
  odometry,     ///< where odometry is missing for a frame: a random walk with the `unknown_motion`
                ///< noise
  random_walk,  ///< the mean stays
  constant_velocity,  ///< the motion per period is part of the state
  still,              ///< the camera stays where it is, exactly
  given  ///< the pose T_world_camera is given with every frame, as on an arm, with an error that is
         ///< drawn anew; without one a random walk with the `unknown_motion` noise
};

/// The words of MotionModel in files.
template <>
inline constexpr WordTable<MotionModel, 5> words<MotionModel>{{
    {"odometry", MotionModel::odometry},
    {"random_walk", MotionModel::random_walk},
    {"constant_velocity", MotionModel::constant_velocity},
    {"still", MotionModel::still},
    {"given", MotionModel::given},
}};

/// How a covariance grows with time.
enum class NoisePer { frame, second };

/// The words of NoisePer in files.
template <>
inline constexpr WordTable<NoisePer, 2> words<NoisePer>{{
    {"frame", NoisePer::frame},
    {"second", NoisePer::second},
}};

/// Noise of a motion: covariance (right perturbation, camera frame) per frame or per second.
struct ProcessNoise {
  Matrix6d covariance = Matrix6d::Identity();
  NoisePer per = NoisePer::second;

  /// Covariance of one step of `dt` seconds.
  Matrix6d over(double dt) const {
    return per == NoisePer::frame ? covariance : Matrix6d(dt * covariance);
  }
};

/// The covariance of a motion's noise that acts at the point at `scene_distance_m` on the optical
/// axis, at the camera. Odometry that follows points of the scene errs in rotation and translation
/// such that those points stay in the image, see OdometryNoise.
inline Matrix6d at_camera(const Matrix6d& covariance, double scene_distance_m) {
  return SE3d(SO3d(), Eigen::Vector3d(0.0, 0.0, scene_distance_m)).adjoint_congruence(covariance);
}

/// Distance of the scene at which the default noise of the odometry acts [m].
inline constexpr double kDefaultSceneDistance = 0.5;

/// Settings of the motion model. Standard deviations below are per square root of a second.
struct MotionSettings {
  MotionModel model = MotionModel::odometry;
  /// Noise of the odometry, of a given pose (whatever the time), or of the pose under constant
  /// velocity: 0.1 deg, 1.3 mm at 0.5 m.
  ProcessNoise noise{at_camera(
      pose_covariance(Eigen::Vector3d::Constant(radians(0.1)), Eigen::Vector3d::Constant(1.3e-3)),
      kDefaultSceneDistance)};
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

}  // namespace posemix
