// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// The rotation vector [rad], along the axes of the object, that takes the direction from it to the
/// camera from that of the first pose in the camera to that of the second; of opposite directions
/// one of many. Its norm is view_angle: zero where the camera is at the object itself.
Eigen::Vector3d view_turn(const SE3d& first, const SE3d& second);

}  // namespace posemix::internal
