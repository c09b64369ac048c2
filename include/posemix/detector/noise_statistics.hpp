// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Statistics of residuals in the order of time.
namespace posemix {

/// One value per frame of a recording; empty where there was no detection.
using ResidualTrack = std::vector<std::optional<double>>;

/// Moments and order statistics. Everything is NaN where there are too few values.
struct AxisStatistics {
  std::size_t count = 0;
  double mean;
  double sd;  ///< about the mean, by count
  double rms;
  double median;
  double robust_sd;  ///< 1.4826 times the median distance from the median
  double skewness;
  double kurtosis;  ///< fourth moment by squared variance: 3 for a Gaussian
};

AxisStatistics axis_statistics(std::span<const ResidualTrack> tracks);

/// Standard deviation of the tracks' means, over tracks with a value; NaN for fewer than two.
double spread_of_means(std::span<const ResidualTrack> tracks);

/// Correlation of residuals in time.
struct Autocorrelation {
  std::vector<double> at_lag;  ///< entry k at a distance of k frames; entry 0 is 1
  double lag1;                 ///< NaN where there are no neighbours
  /// Number of frames that count as one: 1 + 2 sum of the autocorrelation, at least 1. The sum ends
  /// before the first even lag at which the sum of the autocorrelation there and at the next lag is
  /// not positive (Geyer, Practical Markov chain Monte Carlo, 1992: initial positive sequence).
  double correlation_frames;
  double effective_count;  ///< number of values divided by correlation_frames
};

/// Pairs are formed within a track, about the mean of the track; spread_of_means measures the
/// difference between tracks. Lags go up to half of the longest track, at most `max_lag`.
Autocorrelation autocorrelation(std::span<const ResidualTrack> tracks, std::size_t max_lag = 1000);

}  // namespace posemix
