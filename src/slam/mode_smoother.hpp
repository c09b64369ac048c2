// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/filter/mode_measurement.hpp"
#include "posemix/slam/frame_input.hpp"
#include "posemix/slam/motion_settings.hpp"
#include "slam/motion.hpp"

/// Smoothing of one mode per object. In the room `slam` only.
namespace posemix::internal {

/// How camera and objects move and are seen, one mode of each object.
struct ModeModel {
  MotionSettings motion;
  double odometry_camera_fraction = 1.0;  ///< as in MultiObjectSettings
  double correlation_length = 1.0;        ///< odometry's noise is divided by it
  GainCovariance gain_covariance = GainCovariance::update;
  std::vector<std::size_t> objects = {};  ///< of the pose at first_object() and on
  std::vector<const ObjectSensor*> sensors = {};

  bool has_motion() const { return motion.model == MotionModel::constant_velocity; }
  std::size_t first_object() const { return has_motion() ? 2 : 1; }
};

/// Camera, its motion and objects at every frame, from all of the frames (docs/filter.md,
/// smoothing); covariances as the filter has them. `start` holds before the first frame.
class ModeSmoother {
 public:
  ModeSmoother(const ModeModel& model, std::span<const FrameInput* const> frames)
      : model_(model), frames_(frames) {}

  /// A pass that is linearised, and weighs the components of the noise, where it predicts.
  void pass(const Hypothesis& start) { run(start, {}); }
  /// The same at the result of the pass before.
  void refine(const Hypothesis& start) { run(start, smoothed_); }

  const std::vector<Hypothesis>& smoothed() const { return smoothed_; }

 private:
  /// A Gaussian of xi in X = Exp(xi) reference, before and after the detections of a frame.
  struct Step {
    PoseStackd reference;
    Eigen::VectorXd predicted_mean;
    Eigen::MatrixXd predicted;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    Eigen::MatrixXd noise;     ///< of the transition to this frame
    Eigen::MatrixXd transfer;  ///< xi_camera += transfer xi_motion, where there is a motion
  };

  void run(const Hypothesis& start, const std::vector<Hypothesis>& reference);
  Step predict(const PoseStackd& poses, const Eigen::MatrixXd& covariance, const FrameInput& input,
               PoseStackd& moved) const;
  void move(const CameraStep& camera, const PoseStackd& poses, Step& step, PoseStackd& moved) const;
  void update(Step& step, const FrameInput& input, const Eigen::MatrixXd& weighing) const;
  void backward();

  const ModeModel& model_;
  std::span<const FrameInput* const> frames_;
  std::vector<Step> steps_;
  std::vector<Hypothesis> smoothed_;
};

}  // namespace posemix::internal
