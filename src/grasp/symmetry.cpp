// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/symmetry.hpp"

#include <cmath>
#include <numbers>

namespace posemix {
namespace {

/// The symmetry nearest to the inverse of a rotation's part about the axis.
SE3d undoing(const SO3d& rotation, const AxisSymmetry& symmetry) {
  const Eigen::Quaterniond& q = rotation.quaternion();
  double angle = -2.0 * std::atan2(q.vec().dot(symmetry.axis), q.w());
  if (symmetry.fold > 0) {
    const double step = 2.0 * std::numbers::pi / symmetry.fold;
    angle = step * std::round(angle / step);
  }
  return SE3d(SO3d::exp(angle * symmetry.axis), Eigen::Vector3d::Zero());
}

}  // namespace

SE3d reduced_error(const SE3d& error, const AxisSymmetry& symmetry) {
  return undoing(error.rotation(), symmetry) * error;
}

SE3d nearest_equivalent(const SE3d& pose, const SE3d& reference, const AxisSymmetry& symmetry) {
  return pose * undoing(reference.rotation().inverse() * pose.rotation(), symmetry);
}

}  // namespace posemix
