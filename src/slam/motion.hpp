// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/filter/predict.hpp"
#include "posemix/slam/frame_estimate.hpp"
#include "posemix/slam/frame_input.hpp"
#include "posemix/slam/motion_settings.hpp"

/// The motion models, the same for every tracker and for smoothing.
namespace posemix::internal {

/// How the camera moves over one frame. Covariances are of right perturbations, camera frame.
struct CameraStep {
  /// Under constant velocity: the camera moves by the motion of the state, which is its motion per
  /// reference period.
  struct Velocity {
    double periods;    ///< length of the frame in reference periods
    Matrix6d q;        ///< noise of the motion
    Matrix6d at_rest;  ///< covariance of the motion at first
  };

  double dt = 0.0;               ///< seconds
  std::optional<SE3d> odometry;  ///< T_camera(k-1)_camera(k); empty: the mean stays, or has a
                                 ///< velocity
  Matrix6d q;                    ///< noise of the camera's pose
  std::optional<Velocity> velocity;
  /// The camera's pose, where it is given.
  std::optional<PoseDensity> given = {};
};

/// The settings as they are given.
/// @throws InvalidInput when the period is not positive and finite, or as `check_noise` for a noise
const MotionSettings& checked(const MotionSettings& motion);

/// @throws InvalidInput for a model in which the camera is given, which `where` does not have
void require_not_given(const MotionSettings& motion, const char* where);

/// The step of one frame by its motion model; a frame without odometry is one of unknown motion.
/// @throws InvalidInput when dt is so long that the noise is not finite
CameraStep camera_step(const MotionSettings& motion, const FrameInput& input);

/// Moves the camera by one frame.
Hypothesis predict(Hypothesis hypothesis, const CameraStep& step);
void predict(MultiObjectFilter& filter, const CameraStep& step);

/// The camera alone, with its motion (at rest) where the model needs one.
Hypothesis camera_hypothesis(const PoseDensity& camera, const MotionSettings& motion);

}  // namespace posemix::internal
