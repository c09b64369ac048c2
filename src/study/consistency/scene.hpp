// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/slam/frame_input.hpp"
#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/object_model.hpp"
#include "study.hpp"

namespace posemix {

/// The model of the detector in a cell, which the filter is told and the simulation draws from.
DetectorNoise detector_of(const ConsistencyCell& cell);

SymmetryGroup symmetries_of(ObjectShape shape);

/// The motion model of a cell.
MotionSettings motion_of(const ConsistencyCell& cell);

/// A draw of N(0, covariance).
Vector6d draw_error(const Matrix6d& covariance, RandomStream& random);

/// A camera that circles objects one metre away, 11 degrees a second; without odometry it walks as
/// its motion model says. The errors of the detector are drawn from docs/many-objects.md, eq. (D1),
/// by code of their own.
class ConsistencyScene {
 public:
  ConsistencyScene(const ConsistencyCell& cell, RandomStream random);

  const SE3d& camera() const { return camera_; }
  const std::vector<SE3d>& objects() const { return objects_; }

  /// The next frame, `dt` seconds after the last one, with detections where `seen`.
  FrameInput next(double dt, bool seen);

 private:
  struct Detector {
    Vector6d slow;
    Eigen::Vector3d view;
    bool flipped = false;
    std::size_t gross_left = 0;  ///< detections that are left in a run of gross errors
    Vector6d gross = Vector6d::Zero();
    SE3d common = {};  ///< the error that all detections have in common, along the object's axes
    std::size_t detections = 0;
    double right_weight = 0.5;  ///< of the right one of two modes
  };

  void move(double dt, FrameInput& input);
  void move_slow_error(std::size_t object, double dt);
  std::optional<SE3d> detect(std::size_t object);
  /// The detection of the right mode as what is told of it.
  void add_modes(std::size_t object, const SE3d& seen, FrameInput& input);
  SE3d clutter(const SE3d& near);
  /// The error of an inlier, or of a gross error, which lasts for a run.
  Vector6d white_error(Detector& detector);

  ConsistencyCell cell_;
  DetectorNoise noise_;
  MotionSettings motion_;
  RandomStream random_;
  double time_s_ = 0.0;
  bool is_first_ = true;
  SE3d camera_;
  std::vector<SE3d> objects_;
  std::vector<Detector> detectors_;
};

}  // namespace posemix
