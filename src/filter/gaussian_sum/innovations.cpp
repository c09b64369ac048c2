// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "innovations.hpp"

#include <utility>

#include "lie/pose_kernels.hpp"
#include "posemix/lie/pose_blocks.hpp"
#include "world_noise.hpp"

namespace posemix::internal {

void Innovations::set(const PoseStackd& mean, std::span<const Detection> detections,
                      std::span<const NoiseComponent* const> components) {
  const std::size_t count = components.size();
  detected_.resize(count);
  objects_.resize(count);
  axes_.resize(count);
  noise.resize(count);
  residual.resize(offset(count));
  const SE3d& camera = mean[kCamera];
  for (std::size_t j = 0; j < count; ++j) {
    const Detection& detection = detections[j % detections.size()];
    detected_[j] = without_offset(detection.camera_object, *components[j]);
    objects_[j] = mean[detection.object];
    axes_[j] = noise_axes(*components[j], camera.rotation(), objects_[j]);
    noise[j] = components[j]->covariance;
  }
  residual_of(camera, rows_of(std::as_const(detected_).data()),
              rows_of(std::as_const(objects_).data()), {residual.data(), kPoseDof}, count);
  adjoint_congruence_of(rows_of(std::as_const(axes_).data()), {noise.data()->data(), 36},
                        {noise.data()->data(), 36}, count);
}

}  // namespace posemix::internal
