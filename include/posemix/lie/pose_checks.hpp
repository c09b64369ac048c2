// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

#include "posemix/base/limits.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

/// What is asked of poses and of their covariances before anything is computed with them. `name`
/// begins the message of an error.
namespace posemix {

/// Whether the pose is finite, and no coordinate beyond kFarthestPosition.
bool is_valid_pose(const SE3d& pose);

/// @throws InvalidInput unless is_valid_pose()
void check_pose(const SE3d& pose, std::string_view name);

/// @throws InvalidInput when an entry is not finite, or a variance beyond kLargestVariance
void check_variances(const Matrix6d& covariance, std::string_view name);

/// Checks the covariance of a noise, which may be zero in some directions.
/// @throws InvalidInput as check_variances, and when the matrix is not symmetric up to rounding
/// (1e-9 of its largest entry) or its symmetric part is not positive semidefinite. That is what is
/// to be computed with: beside a large variance 1e-9 of it is more than small ones.
void check_noise(const Matrix6d& covariance, std::string_view name);

}  // namespace posemix
