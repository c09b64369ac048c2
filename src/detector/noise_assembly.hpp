// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include "posemix/detector/noise_correlation.hpp"
#include "posemix/detector/slow_error_fit.hpp"

/// The noise model of a filter from the parts that were fitted one by one.
namespace posemix::internal {

/// Index of the heaviest component without an offset, which tells inliers; of the first one where
/// all have an offset.
std::size_t inlier_index(const DetectorNoise& noise);

/// A mixture that was fitted to single detections, with the dependence of successive ones.
///
/// * The inlier takes the white covariance where there is a slow error or one in common.
/// * Of the covariances of the others, the slow error and the one in common are taken away, as far
///   as they stay no narrower than the inlier.
/// * Wider components without an offset have as run length the number of detections outside the
///   inlier that count as one (NoiseCorrelation::outlier, within); the mode time is that number in
///   seconds, zero without stamps.
/// * Clutter has at least the weight `least_clutter`.
DetectorNoise assembled_noise(const DetectorNoise& mixture, const SlowErrorFit& slow_error,
                              const NoiseCorrelation& correlation,
                              std::span<const NoiseTrack> tracks, double least_clutter,
                              double clutter_volume_m3);

}  // namespace posemix::internal
