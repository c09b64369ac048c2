// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <span>

#include "base/kept_memory.hpp"
#include "posemix/filter/update.hpp"

/// The noise of a detection, carried into the world frame by the camera's axes: an iterated update
/// turns them with its iterates. The multi-object filter, which does not iterate, takes the axes at
/// the pose itself (noise_at in detector_noise.hpp).
namespace posemix::internal {

/// The pose E of the axes in which the noise is stated: that of `object` times the offset for
/// NoiseFrame::object, the same with the rotation of `camera` for NoiseFrame::camera. All poses are
/// in one frame.
inline SE3d noise_axes(const NoiseComponent& noise, const SO3d& camera, const SE3d& object) {
  const SE3d mode = object * noise.offset;
  return noise.frame == NoiseFrame::camera ? SE3d(camera, mode.translation()) : mode;
}

/// The noise covariance in the world frame, Ad(E) R Ad(E)^T.
inline Matrix6d world_noise(const NoiseComponent& noise, const SE3d& camera, const SE3d& object) {
  if (noise.frame == NoiseFrame::ray)
    return world_noise(along_camera(noise, camera.inverse() * object), camera, object);
  return noise_axes(noise, camera.rotation(), object).adjoint_congruence(noise.covariance);
}

/// The noise components of several detections for one mean, one or more for each: by noise, then by
/// detection. A component along the viewing ray
/// becomes one along the camera's axes; the others stay as they are. The iterations of an update
/// then keep the ray of the prior mean.
class NoiseAtMean {
 public:
  NoiseAtMean(const PoseStackd& mean, std::span<const Detection> detections,
              std::span<const NoiseComponent* const> noise)
      : pointers_(noise.begin(), noise.end()) {
    resolved_.reserve(static_cast<std::size_t>(std::count_if(
        noise.begin(), noise.end(),
        [](const NoiseComponent* component) { return component->frame == NoiseFrame::ray; })));
    for (std::size_t j = 0; j < noise.size(); ++j) {
      if (noise[j]->frame != NoiseFrame::ray) continue;
      const SE3d camera_object =
          mean[kCamera].inverse() * mean[detections[j % detections.size()].object];
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
  KeptVector<NoiseComponent> resolved_;
  KeptVector<const NoiseComponent*> pointers_;
};

/// T_camera_object as one component explains the detected pose: without the offset of its mode.
inline SE3d without_offset(const SE3d& camera_object, const NoiseComponent& noise) {
  return camera_object * noise.offset.inverse();
}

}  // namespace posemix::internal
