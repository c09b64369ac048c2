// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "posemix/base/error.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// @throws InvalidInput, which has the name, when the pose is not finite
inline void require_finite_pose(const SE3d& pose, const char* name) {
  if (pose.translation().allFinite() && pose.rotation().quaternion().coeffs().allFinite()) return;
  throw InvalidInput(std::string(name) + " holds a value that is not finite");
}

/// @throws InvalidInput, which has the name, when the covariance is not finite or a variance is
/// negative; a noise may be zero in some directions
inline void require_process_noise(const Matrix6d& covariance, const char* name) {
  if (!covariance.allFinite())
    throw InvalidInput(std::string(name) + " holds a value that is not finite");
  if (covariance.diagonal().minCoeff() < 0.0)
    throw InvalidInput(std::string(name) + " has a negative variance");
}

}  // namespace posemix::internal
