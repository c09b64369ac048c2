// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "posemix/detector/noise_observation.hpp"
#include "posemix/detector/noise_statistics.hpp"

/// Correlation in time of the errors of a detector.
namespace posemix {

/// Number m of frames that carry as much information as one independent frame: the mean over n
/// frames has the variance of a mean over n / m independent ones.
struct DependentFrames {
  /// For whole recordings and errors about zero, so that a common error of a recording counts:
  /// sum (sum x)^2 / sum x^2, with sums over the recordings and over the frames of each. At
  /// least 1.
  double about_zero;
  /// For errors about the mean of each recording: Autocorrelation::correlation_frames.
  double within;
};

DependentFrames dependent_frames(std::span<const ResidualTrack> tracks);

/// Standard deviation about zero of the error that all values of a recording have in common: the
/// mean square of the means of recordings, less the part of it that is due to the scatter within a
/// recording (with one independent value per `within` values); zero where that part is larger.
/// Recordings with fewer than ten values are left out; NaN where no recording remains.
double bias_sd(std::span<const ResidualTrack> tracks, double within);

/// Correlations of the errors of a detector; see noise_correlation.
struct NoiseCorrelation {
  std::size_t inliers = 0;      ///< number of detections within the gate
  DependentFrames inlier = {};  ///< of the whitened residuals of inliers, over all axes
  std::array<DependentFrames, 6> axes = {};  ///< the same by axis
  Vector6d bias_sd = Vector6d::Zero();       ///< of inliers, by axis, in the unit of the residual
  double outlier_share = 0.0;
  double outlier_run = 0.0;      ///< mean length of a run of outliers [detections]
  DependentFrames outlier = {};  ///< of the indicator of outliers, about its mean
};

/// Squared Mahalanobis distance from which on a detection is an outlier. One residual in 3000 of
/// the component itself is beyond it.
inline constexpr double kInlierGate = 25.0;

/// The correlations of inliers, which are the detections within the gate of the component `inlier`
/// (its offset is ignored), and of the indicator of outliers.
NoiseCorrelation noise_correlation(std::span<const NoiseTrack> tracks,
                                   const NoiseComponent& inlier);

}  // namespace posemix
