// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/detector/symmetry.hpp"

/// Errors of poses of objects that have symmetries.
namespace posemix {

/// The maximum symmetry-aware surface distance of the BOP benchmark (Hodan et al., "BOP Challenge
/// 2020", eq. 2): the least over the group of max_p |estimate p - truth g p|, p over `points` of
/// the object's surface (object frame, m): the vertices of its mesh, or the corners of its box.
///
/// Elements are tried one by one. The angle about an axis is looked for at the 315 angles of the
/// BOP toolkit (its max_sym_disc_step of 0.01) and then between them, so that the result is at most
/// the toolkit's. Under all rotations about a point it is the distance by which that point moved,
/// which is exact where the points' mean is the point, and otherwise an upper bound.
/// @throws InvalidInput without points
double max_symmetric_surface_distance(const SE3d& estimate, const SE3d& truth,
                                      std::span<const Eigen::Vector3d> points,
                                      const SymmetryGroup& symmetries);

/// Difference of two poses.
struct SymmetricPoseError {
  double rotation_rad = 0.0;   ///< angle between the rotations
  double translation_m = 0.0;  ///< distance of the positions
};

/// The error against the equivalent truth that is nearest, in terms of rotation^2 + (translation /
/// length_m)^2.
SymmetricPoseError symmetric_pose_error(const SE3d& estimate, const SE3d& truth,
                                        const SymmetryGroup& symmetries, double length_m = 0.1);

}  // namespace posemix
