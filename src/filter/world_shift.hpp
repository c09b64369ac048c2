// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/density/concentrated_gaussian.hpp"

namespace posemix::internal {

/// What is farther from the origin than this [m] is computed near the scene.
inline constexpr double kFarFromOrigin_m = 50.0;

/// A world whose origin is elsewhere. Errors of poses are turns about the origin: far from it the
/// covariances of small errors are differences of large numbers, and their factors lose them to
/// rounding. Filters thus compute near the scene, which changes nothing else: all that they do is
/// invariant to where the origin is.
class WorldShift {
 public:
  /// Of what was at the old origin in the new world [m].
  explicit WorldShift(const Eigen::Vector3d& shift) : shift_(shift), lever_(SO3d::hat(shift)) {}

  WorldShift inverse() const { return WorldShift(-shift_); }
  bool is_none() const { return shift_.isZero(0.0); }

  SE3d operator()(const SE3d& pose) const {
    return is_none() ? pose : SE3d(pose.rotation(), pose.translation() + shift_);
  }
  /// Of xi_A in a covariance with anything, six rows: Ad of a translation is [1 0; t^ 1].
  template <class Rows>
  void move_rows(Rows&& of_pose) const {
    if (!is_none()) of_pose.template bottomRows<3>() += lever_ * of_pose.template topRows<3>();
  }
  /// The same for six columns.
  template <class Columns>
  void move_columns(Columns&& of_pose) const {
    if (is_none()) return;
    of_pose.template rightCols<3>() += of_pose.template leftCols<3>() * lever_.transpose();
  }
  /// A covariance of two poses of the world.
  Matrix6d operator()(Matrix6d covariance) const {
    move_rows(covariance);
    move_columns(covariance);
    return covariance;
  }
  ConcentratedGaussian<SE3d> operator()(const ConcentratedGaussian<SE3d>& density) const {
    Matrix6d covariance = (*this)(density.covariance());
    symmetrize(covariance);
    return ConcentratedGaussian<SE3d>::trusted((*this)(density.mean()), covariance);
  }

 private:
  Eigen::Vector3d shift_;
  Eigen::Matrix3d lever_;
};

/// Where a world has its origin that had it at `origin` and has its camera there.
inline Eigen::Vector3d origin_near(const Eigen::Vector3d& camera, const Eigen::Vector3d& origin) {
  return (camera - origin).norm() > kFarFromOrigin_m ? camera : origin;
}

/// To a world whose origin is at a pose that is far from the origin; else none.
inline WorldShift shift_near(const SE3d& pose) {
  const Eigen::Vector3d& place = pose.translation();
  return WorldShift(place.norm() > kFarFromOrigin_m ? Eigen::Vector3d(-place)
                                                    : Eigen::Vector3d(Eigen::Vector3d::Zero()));
}

/// The density of a pose as seen from near it, where it is far from the origin.
inline ConcentratedGaussian<SE3d> seen_from_near(const ConcentratedGaussian<SE3d>& pose) {
  const WorldShift shift = shift_near(pose.mean());
  return shift.is_none() ? pose : shift(pose);
}

}  // namespace posemix::internal
