// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/lie.hpp"

/// Objects that look, or are grasped, the same after a rotation about an axis.
namespace posemix {

/// Rotations about an axis through the object's origin that change nothing.
struct AxisSymmetry {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of length one, object frame
  int fold = 0;  ///< by multiples of a turn / fold; 0: by any angle
};

/// The error T_truth^-1 T_estimate against the one of the equivalent truths that has the least
/// rotation: S error with a symmetry S.
SE3d reduced_error(const SE3d& error, const AxisSymmetry& symmetry);

/// The pose equivalent to `pose` (pose S) whose rotation is nearest to that of `reference`.
SE3d nearest_equivalent(const SE3d& pose, const SE3d& reference, const AxisSymmetry& symmetry);

}  // namespace posemix
