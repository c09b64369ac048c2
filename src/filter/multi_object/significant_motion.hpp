// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "filter/world_shift.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/density/concentrated_gaussian.hpp"

/// What of the motion of a body is beyond its noise: by the rest nothing is told of the poses of
/// cameras on it, eq. (38) of docs/many-objects.md.
namespace posemix::internal {

/// Directions in the body's axes, along and about which motions are compared with their noise:
/// those in which the body moved by the most beside it, which are the same from motion to motion
/// for a robot that drives on a plane, whatever its axes are.
class MotionDirections {
 public:
  struct Coordinates {
    Matrix6d to;    ///< of a motion, along the directions
    Matrix6d from;  ///< the inverse
  };
  Coordinates beside(const Matrix6d& noise) const;
  /// A motion that is significant, with the covariance of its error.
  void add(const Vector6d& motion, const Matrix6d& noise);

 private:
  template <class>
  friend struct StateFields;

  Matrix6d motions_ = Matrix6d::Zero();  ///< sum of the squares of the last ones
  Matrix6d noise_ = Matrix6d::Zero();    ///< sum of their covariances
};

/// Of a body with odometry. Steps add up from one detection to the next: what a detection saw of a
/// motion is not seen anew.
class SignificantMotion {
 public:
  /// The part of a step, with the covariance `q` of its error in the body's axes after it, and of
  /// what is left of the steps since the last detection, that is significant.
  SE3d take(const SE3d& step, const Matrix6d& q);
  /// A detection by a camera whose pose is estimated, which has seen what is left.
  void see() {
    motion_.setZero();
    noise_.setZero();
  }

 private:
  template <class>
  friend struct StateFields;

  MotionDirections directions_;
  Vector6d motion_ = Vector6d::Zero();  ///< that was not taken, in the body's axes
  Matrix6d noise_ = Matrix6d::Zero();   ///< its covariance
};

/// Of a body whose pose is given.
class SignificantPose {
 public:
  /// The pose that follows what is given, with a covariance in the body's axes, where it is
  /// significantly elsewhere. Along other directions it is their mean, weighted by their
  /// information.
  const SE3d& follow(const SE3d& pose, const Matrix6d& covariance);
  void move_world(const WorldShift& shift);

 private:
  template <class>
  friend struct StateFields;

  /// With a covariance in its own axes.
  struct Pose {
    SE3d pose;
    Matrix6d covariance = Matrix6d::Zero();
  };

  MotionDirections directions_;
  bool has_pose_ = false;
  Pose follower_;
  Pose last_;  ///< given, when the follower moved last
};

/// The pose at which cameras on a body are linearised, that follows it after a detection with this
/// noise, world frame: no nearer than where detections alone take a body that stands.
SE3d near_body(const SE3d& at, const SE3d& body, const Matrix6d& noise);
/// Whether a body is farther from where it was than detections with this noise take one that
/// stands.
bool is_elsewhere(const SE3d& before, const SE3d& body, const Matrix6d& noise);

/// The motion of a body on which poses of cameras are estimated.
struct RigMotion {
  /// A detection by a camera whose pose on the body is estimated, or by an exact one.
  void see(std::optional<std::size_t> camera) {
    if (camera) odometry.see();
    if (!camera) is_seen_exactly = true;
  }
  /// A camera whose pose is estimated moved the body by a detection with this noise, world frame.
  void correct(const SE3d& before, const SE3d& body, const Matrix6d& noise) {
    if (is_told && is_elsewhere(before, body, noise)) is_seen_exactly = false;
  }

  SignificantMotion odometry;
  SignificantPose given;
  bool is_told = true;  ///< how the body moved last: by odometry or a pose
  /// Whether an exact camera has told where the body is, and no other one has corrected that since.
  bool is_seen_exactly = false;
};

}  // namespace posemix::internal
