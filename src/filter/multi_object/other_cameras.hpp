// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "filter/same_camera.hpp"
#include "joint_gaussian.hpp"

/// Slow errors of the cameras on a rig: docs/many-objects.md, "Slow errors on a rig".
namespace posemix::internal {

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;

/// The slow error b_k of a camera that saw a hypothesis and does not now: given the error e of the
/// pose as this camera sees it, and the slow error b of the camera that does see,
/// N(mean + given [e; b - seeing], covariance), eq. (39). e is xi_O - xi_C along the axes of the
/// world at the object.
struct OtherCamera {
  ObservationSource source = {};
  Vector6d mean = Vector6d::Zero();
  Matrix6x12d given = Matrix6x12d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  SE3d body = {};                      ///< mean of T_world_body, with which e turns
  SE3d body_object = {};               ///< the mean that e is of
  Vector6d seeing = Vector6d::Zero();  ///< the mean of b
  bool is_followed = true;             ///< whether the object was seen since the last motion

  auto on_error() const { return given.leftCols<6>(); }
  auto on_seeing() const { return given.rightCols<6>(); }
  /// The means of the poses and of b were corrected to these. What turns the body turns e.
  void follow(const SE3d& body, const SE3d& object, const Vector6d& mean_of_seeing);
};

/// The slow error of a camera, N(mean + on_object (xi_O - xi_C) + on_seeing (b - b0), covariance).
struct CameraSlowError {
  Vector6d mean = Vector6d::Zero();
  Matrix6d on_object = Matrix6d::Zero();
  Matrix6d on_seeing = Matrix6d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

/// A hypothesis as the cameras of a rig see it.
class SeenByRig {
 public:
  SeenByRig(const JointGaussian& joint, const ConditionalPose& pose)
      : joint_(joint), pose_(pose), rig_(joint.rig()), cross_(12, rig_.cols()) {
    cross_.leftCols<6>() = pose.cross_covariance;
    cross_.rightCols(pose.extrinsics.cols()) = pose.extrinsics;
    to_place_ = SE3d(SO3d(), -pose.pose.translation()).adjoint();
  }

  /// Covariance of the errors of two cameras.
  Matrix6d errors(const ObservationSource& a, const ObservationSource& b) const;
  /// Covariance of the error of a camera and of what of it is not the body's.
  Matrix6d error_and_own(const ObservationSource& a) const;
  /// Covariance of b and the error of a camera, and of b and what of it is not the body's.
  Matrix6d slow_and_error(const ObservationSource& a) const;
  Matrix6d slow_and_own(const ObservationSource& a) const;
  Matrix6d slow() const { return pose_.covariance.bottomRightCorner<6, 6>(); }
  /// From the world to the axes of e.
  const Matrix6d& to_place() const { return to_place_; }

 private:
  Matrix6d errors(const Eigen::MatrixXd& by_a, const Eigen::MatrixXd& by_b) const;
  Matrix6d slow_and_error(const Eigen::MatrixXd& by) const;
  /// M of a camera without the columns of the body.
  Eigen::MatrixXd own(const ObservationSource& a) const;

  const JointGaussian& joint_;
  const ConditionalPose& pose_;
  Eigen::MatrixXd rig_;
  Eigen::Matrix<double, 12, Eigen::Dynamic> cross_;
  Matrix6d to_place_;
};

/// Second moments of b_k: its own, and with e and b.
struct OtherMoments {
  Matrix6d own;
  Matrix6x12d with_given;
};

/// None where the object was not seen since the motion before.
using OtherMomentsList = KeptVector<std::optional<OtherMoments>>;

/// A camera of which nothing was seen yet, eq. (40): `correlation` is that of its slow error with
/// b; both have the covariance `stationary`.
OtherCamera other_camera(const ObservationSource& source, double correlation,
                         const Matrix6d& stationary);

/// Before a motion of the body: moments with the error of after it, which has none of the camera's
/// of before where that is `released`.
OtherMoments moments_before(const OtherCamera& other, const SeenByRig& before, bool released);

/// Eq. (42): after the motion, before b itself decays. Slow errors decay by the factor `a`; the
/// part that is new in those of the two cameras has the correlation `correlation`.
void decay(OtherCamera& other, const OtherMoments& before, const SeenByRig& after, double a,
           double correlation, const Matrix6d& stationary);

/// The same without moments: the noise of the motion is left out.
void decay(OtherCamera& other, double a, const Matrix6d& stationary);

/// Whether a slow error is known to be one: what a motion did to the pose since may have been left
/// out.
bool is_known(const OtherCamera& other, const SeenByRig& seen, const Matrix6d& stationary);

/// Eq. (41): the camera `next` sees in place of `last`, and its slow error becomes b. The others
/// are given that one, and `last` is one of them.
void take_turns(std::vector<OtherCamera>& others, const OtherCamera& next,
                const ObservationSource& last, const SeenByRig& before);

/// All slow errors are multiplied by `factor`, coordinate by coordinate, and b + A^-1 xi_O stays,
/// with the map A of `slow_map` to the axes of e.
void rescale(OtherCamera& other, const Vector6d& factor, const Matrix6d& slow_map);

}  // namespace posemix::internal
