// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/filter/update.hpp"

/// What a noise component says about a detection. In the room `filter` only.
namespace posemix::internal {

/// The pose E of the axes in which the noise is stated: `object` offset for the object's, the same
/// with the camera's rotation for the camera's. Both arguments are in one frame, E is in it too.
inline SE3d noise_axes(const NoiseComponent& noise, const SO3d& camera, const SE3d& object) {
  const SE3d mode = object * noise.offset;
  return noise.frame == NoiseFrame::camera ? SE3d(camera, mode.translation()) : mode;
}

/// The detection freed of its mode: T_camera_object as the component believes it.
inline SE3d without_offset(const Detection& detection, const NoiseComponent& noise) {
  return detection.camera_object * noise.offset.inverse();
}

}  // namespace posemix::internal
