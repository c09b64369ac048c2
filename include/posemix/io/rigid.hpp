// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "posemix/io/text.hpp"
#include "posemix/lie/lie.hpp"

/// Poses as files write them, and their checks.
namespace posemix {

/// Deviation from a rotation that matrices stored as 32-bit floats or as rounded text are allowed.
inline constexpr double kRotationTolerance = 1e-4;

/// Deviation of a quaternion's norm from one that rounded text is allowed.
inline constexpr double kQuaternionNormTolerance = 1e-2;

/// Positions beyond this are in a wrong unit [m].
inline constexpr double kFarthestPosition = 1e8;

/// @throws InvalidInput with `where` before the reason when a coordinate of the position is beyond
/// kFarthestPosition
void check_position(const SE3d& pose, std::string_view where);

/// The pose of a homogeneous 4x4 matrix (metres); the rotation is the one nearest to the matrix's.
///
/// Throws InvalidInput, with `where` before the reason, when an entry is not finite, when an entry
/// of R^T R - I exceeds `tolerance`, when the determinant is negative (a reflection), or when the
/// bottom row is not 0 0 0 1 within `tolerance`.
SE3d pose_from_matrix(const Eigen::Matrix4d& matrix, std::string_view where,
                      double tolerance = kRotationTolerance);

/// Seven numbers `tx ty tz qx qy qz qw`: metres and a quaternion, as TUM files write a pose.
using PoseNumbers = std::array<double, 7>;

/// The pose of seven numbers; the quaternion is normalised. Throws InvalidInput at the reader's
/// line when the norm of the quaternion is further than kQuaternionNormTolerance from one.
SE3d pose_from_numbers(const PoseNumbers& numbers, const LineReader& reader);

/// The seven numbers of a pose with 12 significant digits, separated by blanks.
std::string format_pose(const SE3d& pose);

}  // namespace posemix
