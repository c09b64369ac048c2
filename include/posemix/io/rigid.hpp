// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "posemix/base/limits.hpp"
#include "posemix/io/text.hpp"
#include "posemix/lie/lie.hpp"

/// Poses in the forms that files have, and their checks.
namespace posemix {

/// Largest accepted deviation from a rotation, for matrices stored as 32-bit floats or rounded
/// text.
inline constexpr double kRotationTolerance = 1e-4;

/// Largest accepted deviation of a quaternion's norm from one, for rounded text.
inline constexpr double kQuaternionNormTolerance = 1e-2;

/// Checks that no coordinate of the position is beyond kFarthestPosition.
/// @throws InvalidInput otherwise, with `where` before the reason
void check_position(const SE3d& pose, std::string_view where);

/// The pose of a homogeneous 4x4 matrix (metres); its rotation is the one nearest to the upper left
/// block.
/// @throws InvalidInput, with `where` before the reason, when an entry is not finite, an entry of
/// R^T R - I exceeds `tolerance`, the determinant is negative (a reflection), or the bottom row is
/// not 0 0 0 1 within `tolerance`
SE3d pose_from_matrix(const Eigen::Matrix4d& matrix, std::string_view where,
                      double tolerance = kRotationTolerance);

/// Seven numbers `tx ty tz qx qy qz qw`: metres and a quaternion, the pose of a TUM file.
using PoseNumbers = std::array<double, 7>;

/// The pose of seven numbers; the quaternion is normalised.
/// @throws InvalidInput at the reader's line when the norm of the quaternion differs from one by
/// more than kQuaternionNormTolerance
SE3d pose_from_numbers(const PoseNumbers& numbers, const LineReader& reader);

/// The seven numbers of a pose with 12 significant digits, separated by blanks.
std::string format_pose(const SE3d& pose);

}  // namespace posemix
