// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "posemix/detector/noise_observation.hpp"

/// The likelihood of residuals with white, slow and common parts.
namespace posemix::internal {

/// The residual of an inlier, and what has passed since the one before it in the track.
struct SlowRow {
  double angle_rad = 0.0;  ///< path of the viewing direction
  double time_s = 0.0;     ///< NaN where a stamp is missing
  Vector6d residual;
  Matrix6d from_object;  ///< takes an error along the object's axes to the axes of the residual
};

/// The inliers of one track.
struct SlowTrack {
  std::size_t recording = 0;
  std::vector<SlowRow> rows = {};
};

/// The tracks with an inlier. @throws InvalidInput when stamps decrease
std::vector<SlowTrack> slow_tracks(std::span<const NoiseTrack> tracks,
                                   const NoiseComponent& inlier);

/// Variances by axis and lengths of correlation.
struct SlowVariances {
  Vector6d white = Vector6d::Zero();
  Vector6d slow = Vector6d::Zero();
  double angle_rad = std::numeric_limits<double>::infinity();
  double time_s = std::numeric_limits<double>::infinity();
  Vector6d common = Vector6d::Zero();  ///< along the object's axes
  bool has_common = false;
};

/// Log-likelihood of the residuals of a track [nats].
double log_likelihood(const SlowTrack& track, const SlowVariances& variances);

}  // namespace posemix::internal
