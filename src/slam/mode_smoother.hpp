// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "posemix/filter/mode_measurement.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/smoothing.hpp"
#include "slam/motion.hpp"

/// Smoothing of one mode per object. In the room `slam` only.
namespace posemix::internal {

/// How camera and objects move and are seen, one mode of each object.
struct ModeModel {
  MotionSettings motion;
  const MultiObjectFilter* filter = nullptr;  ///< whose sensors are used
  std::vector<std::size_t> objects = {};      ///< of the pose at first_object() and on
  std::vector<const ObjectSensor*> sensors = {};
  /// T_body_camera of all that see: each has a slow error of its own. None: all have the same.
  std::vector<SE3d> cameras = {};

  bool has_motion() const { return motion.model == MotionModel::constant_velocity; }
  std::size_t first_object() const { return has_motion() ? 2 : 1; }
  std::size_t poses() const { return first_object() + objects.size(); }
  std::size_t slow_per_object() const { return std::max(cameras.size(), std::size_t{1}); }
  bool has_slow(std::size_t j) const { return sensors[j]->noise.dependence().slow.has_value(); }
  /// Index among the slow errors of the first camera's of object `j` of the model, whose detector
  /// has them; those of the other cameras follow. With the number of objects, of all of them.
  std::size_t slow_index(std::size_t j) const;
  /// That of a camera, where the detector has slow errors.
  std::optional<std::size_t> slow_index(std::size_t j, const SE3d& body_camera) const;
  /// Correlation of the slow errors of two cameras that see the object at once.
  double correlation(std::size_t j, const SE3d& body_object, std::size_t a, std::size_t b) const;
};

/// Camera, its motion, objects and the slow errors of their detectors at every frame, from all of
/// the frames (docs/filter.md, smoothing). `start` holds before the first frame.
class ModeSmoother {
 public:
  ModeSmoother(const ModeModel& model, std::span<const SmootherFrame* const> frames)
      : model_(model), frames_(frames) {}

  /// A pass that is linearised, and weighs the components of the noise, where it predicts.
  void pass(const JointState& start) { run(start, {}); }
  /// The same at the result of the pass before.
  void refine(const JointState& start) { run(start, smoothed_); }

  const std::vector<JointState>& smoothed() const { return smoothed_; }
  /// Covariance of the camera's error at every frame with that at the frame before; zero at the
  /// first.
  const std::vector<Matrix6d>& camera_lags() const { return camera_lags_; }

 private:
  /// A Gaussian of [xi; beta] in X = Exp(xi) X0, b = b0 + beta about the reference (X0, b0), before
  /// and after the detections of a frame.
  struct Step {
    PoseStackd poses;      ///< X0
    Eigen::VectorXd slow;  ///< b0
    Eigen::VectorXd predicted_mean;
    Eigen::MatrixXd predicted;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    Eigen::MatrixXd noise;      ///< of the transition to this frame
    Eigen::MatrixXd transfer;   ///< xi_camera += transfer xi_motion, where there is a motion
    Eigen::VectorXd slow_kept;  ///< beta <- slow_kept beta, by coordinate
    bool is_given = false;      ///< the camera is given, whatever it was before
  };

  void run(const JointState& start, const std::vector<JointState>& reference);
  Step predict(const JointState& before, const FrameInput& input, JointState& moved) const;
  void move(const CameraStep& camera, const PoseStackd& poses, Step& step, PoseStackd& moved) const;
  void decay_slow_errors(const PoseStackd& poses, double dt, Step& step, JointState& moved) const;
  ModeState state_of(const PoseStackd& poses, const Eigen::VectorXd& slow,
                     const Eigen::MatrixXd& covariance, std::size_t j,
                     const std::optional<std::size_t>& slow_index) const;
  void update(Step& step, const SmootherFrame& frame, const Eigen::MatrixXd& weighing,
              bool is_first) const;
  void update(Step& step, std::size_t j, const std::optional<std::size_t>& slow_index,
              const ModeMeasurement& seen) const;
  void backward();
  /// The state about the reference of a step.
  static JointState at(const Step& step, const Eigen::VectorXd& mean, Eigen::MatrixXd covariance);

  const ModeModel& model_;
  std::span<const SmootherFrame* const> frames_;
  std::vector<Step> steps_;
  std::vector<JointState> smoothed_;
  std::vector<Matrix6d> camera_lags_;
};

}  // namespace posemix::internal
