// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/detector/odometry_noise.hpp"

/// The windows of a recording with odometry, and the distance of the scene that it saw.
namespace posemix::internal {

/// A window by its first and last frame, both with odometry and truth.
struct OdometryFrames {
  std::size_t first;
  std::size_t last;
};

/// The windows of about `length` seconds; they begin a quarter of it apart.
std::vector<OdometryFrames> odometry_windows(const OdometryRecording& recording, double length);

/// Number of windows that do not overlap, of `count` windows that last `seconds` together.
double independent_windows(const OdometryRecording& recording, std::size_t count, double seconds);

/// Variances by the medians of the squares, for errors that are normal but for spikes.
Vector6d robust_variances(const std::vector<Vector6d>& errors);

/// The poses of the point at `distance_m` on the optical axis, with the axes of the camera.
OdometryRecording at_scene_point(OdometryRecording recording, double distance_m);

struct SceneDistance {
  double distance_m = 0.0;
  double error_m = 0.0;  ///< standard error by the bootstrap; NaN for fewer than two recordings
};

/// The distance at which the coordinates of the random walk depend least on each other: the one of
/// the least sum of the log rates at which their variances grow, for the determinant of its
/// covariance is the same at all.
SceneDistance scene_distance(std::span<const OdometryRecording> recordings,
                             const OdometryNoiseSettings& settings);

}  // namespace posemix::internal
