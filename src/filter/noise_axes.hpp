// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <vector>

#include "posemix/filter/update.hpp"

/// What a noise component says about a detection. In the room `filter` only.
namespace posemix::internal {

/// The pose E of the axes in which the noise is stated: `object` offset for the object's, the same
/// with the camera's rotation for the camera's. Both arguments are in one frame, E is in it too.
inline SE3d noise_axes(const NoiseComponent& noise, const SO3d& camera, const SE3d& object) {
  const SE3d mode = object * noise.offset;
  return noise.frame == NoiseFrame::camera ? SE3d(camera, mode.translation()) : mode;
}

/// Components along the viewing ray as they are at a hypothesis' mean, the others as they are.
class NoiseAtMean {
 public:
  NoiseAtMean(const PoseStackd& mean, std::span<const Detection> detections,
              std::span<const NoiseComponent* const> noise)
      : pointers_(noise.begin(), noise.end()) {
    resolved_.reserve(noise.size());
    for (std::size_t j = 0; j < noise.size(); ++j) {
      if (noise[j]->frame != NoiseFrame::ray) continue;
      const SE3d camera_object = mean[kCamera].inverse() * mean[detections[j].object];
      pointers_[j] = &resolved_.emplace_back(along_camera(*noise[j], camera_object));
    }
  }
  NoiseAtMean(const NoiseAtMean&) = delete;
  NoiseAtMean(NoiseAtMean&&) = delete;
  NoiseAtMean& operator=(const NoiseAtMean&) = delete;
  NoiseAtMean& operator=(NoiseAtMean&&) = delete;
  ~NoiseAtMean() = default;

  std::span<const NoiseComponent* const> components() const { return pointers_; }

 private:
  std::vector<NoiseComponent> resolved_;
  std::vector<const NoiseComponent*> pointers_;
};

/// The detection freed of its mode: T_camera_object as the component believes it.
inline SE3d without_offset(const Detection& detection, const NoiseComponent& noise) {
  return detection.camera_object * noise.offset.inverse();
}

}  // namespace posemix::internal
