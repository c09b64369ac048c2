// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "filter/scenario.hpp"
#include "posemix/slam/smoothing.hpp"

/// A short recording drawn from the model, for the tests of smoothing.
namespace posemix::testing {

inline constexpr std::size_t kFrames = 30;
inline constexpr std::size_t kGap = 12;  ///< odometry is missing here
inline const SE3d kStart = pose(0.1, 0.2, -0.1, 0.3, -0.2, 0.1);
inline const std::vector<SE3d> kObjects = {pose(0.4, -0.3, 0.2, 0.1, 0.2, 1.1),
                                           pose(-0.5, 0.3, 0.4, -0.4, 0.2, 1.2)};
inline const Matrix6d kQ = isotropic(0.05, 0.001);
inline const Matrix6d kR = isotropic(0.4, 0.004);
inline const Matrix6d kStartCovariance = isotropic(0.1, 0.002);

/// The filter takes the noise as stated, and corrects the camera in full.
inline ObjectSlamSettings plain_slam_settings() {
  MultiObjectSlamSettings tracker;
  tracker.filter.noise_scale_detections = std::numeric_limits<double>::infinity();
  tracker.filter.camera_gain = 1.0;
  tracker.filter.slow_error_gain = 1.0;
  tracker.filter.camera_rotation_correction = 1.0;
  tracker.filter.camera_position_correction = 1.0;
  tracker.filter.default_clutter = 0.0;
  ObjectSlamSettings settings{.motion = {}, .tracker = tracker};
  settings.motion.noise = {kQ, NoisePer::frame};
  settings.motion.unknown_motion = {isotropic(5.0, 0.1), NoisePer::frame};
  return settings;
}

inline std::vector<ObjectModel> models_with(const DetectorNoise& noise, std::size_t count) {
  std::vector<ObjectModel> models;
  for (std::size_t j = 0; j < count; ++j) models.push_back({std::to_string(j), noise});
  return models;
}

/// A sequence drawn from the model: small errors, the second object seen from frame 4 on, every
/// third frame without it, one step without odometry.
inline Sequence drawn_sequence(std::uint64_t seed, std::size_t objects) {
  RandomStream stream(5, seed);
  Sequence sequence;
  SE3d camera = SE3d::exp(draw(kStartCovariance, stream)) * kStart;
  SE3d odometry;
  for (std::size_t j = 0; j < objects; ++j)
    sequence.objects.push_back({std::to_string(j), {}, {}, {}});
  for (std::size_t k = 0; k < kFrames; ++k) {
    if (k > 0) {
      const SE3d step = pose(0.02, 0.01, 0.0, 0.01, 0.0, 0.02);
      odometry = odometry * step;
      camera = camera * step * SE3d::exp(draw(kQ, stream));
    }
    sequence.stamps.push_back(0.1 * static_cast<double>(k));
    sequence.odometry.push_back(k == kGap ? std::nullopt : std::optional(odometry));
    sequence.camera_truth.emplace_back(camera);
    for (std::size_t j = 0; j < objects; ++j) {
      ObjectRecording& object = sequence.objects[j];
      object.world_truth.emplace_back(kObjects[j]);
      const SE3d seen = camera.inverse() * kObjects[j] * SE3d::exp(draw(kR, stream));
      object.detections.push_back(j == 1 && (k < 4 || k % 3 == 0) ? std::nullopt
                                                                  : std::optional(seen));
    }
  }
  return sequence;
}

/// Norm of the tangent vector from one pose to the other.
inline double distance(const SE3d& a, const SE3d& b) { return (a * b.inverse()).log().norm(); }

}  // namespace posemix::testing
