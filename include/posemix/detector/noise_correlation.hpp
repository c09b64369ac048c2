// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "posemix/detector/noise_fit.hpp"
#include "posemix/detector/noise_statistics.hpp"

/// How the errors of a detector hang together in time.
namespace posemix {

/// One recording: an entry per frame that has a truth, empty where there is no detection.
using NoiseTrack = std::vector<std::optional<NoiseObservation>>;

/// How many frames say as much as one. Of n frames the mean has the variance of n / this many
/// independent ones.
struct DependentFrames {
  /// Over whole recordings and about zero, so that what a recording's errors have in common counts:
  /// sum (sum x)^2 / sum x^2, sums over the recordings and the frames of each. At least 1.
  double about_zero;
  /// About the mean of each recording: Autocorrelation::correlation_frames.
  double within;
};

DependentFrames dependent_frames(std::span<const ResidualTrack> tracks);

/// Standard deviation of what a recording's values have in common, about zero: the mean square of
/// the recordings' means less what their own scatter (its variance by the number of independent
/// values, `within`) adds to it; zero where that is more. Recordings with fewer than ten values do
/// not count; NaN where none is left.
double bias_sd(std::span<const ResidualTrack> tracks, double within);

struct NoiseCorrelation {
  std::size_t inliers = 0;
  DependentFrames inlier = {};  ///< of the whitened residuals, over all axes
  std::array<DependentFrames, 6> axes = {};
  Vector6d bias_sd = Vector6d::Zero();  ///< by axis, in the unit of the residual
  double outlier_share = 0.0;
  double outlier_run = 0.0;      ///< mean length of a run of outliers, detections
  DependentFrames outlier = {};  ///< of the indicator, about its mean
};

/// Squared Mahalanobis distance from which on a detection is an outlier. (A residual of the
/// component itself is beyond it once in 3000.)
inline constexpr double kInlierGate = 25.0;

/// The correlations of inliers, those within the gate of the component `inlier` (which has no
/// offset), and of being an outlier.
NoiseCorrelation noise_correlation(std::span<const NoiseTrack> tracks,
                                   const NoiseComponent& inlier);

}  // namespace posemix
