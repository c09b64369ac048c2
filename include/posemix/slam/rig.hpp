// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "posemix/lie/lie.hpp"

namespace posemix {

/// A camera of several on one body, the rig.
struct BodyCamera {
  std::string name;       ///< Observation::camera
  SE3d body_camera = {};  ///< T_body_camera
};

/// T_body_camera of the camera with the name. Without any cameras every name is the body itself.
/// @throws InvalidInput for another name, with those that there are
SE3d pose_on_body(std::span<const BodyCamera> cameras, std::string_view name);

/// @throws InvalidInput when two cameras share a name, or a pose is not finite
void require_valid(std::span<const BodyCamera> cameras);

}  // namespace posemix
