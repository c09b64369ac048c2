// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "posemix/base/statistics.hpp"

namespace posemix {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Of a Gaussian, standard deviation by median distance from the median.
constexpr double kSdByMedianDistance = 1.482602218505602;

std::vector<double> values_of(std::span<const ResidualTrack> tracks) {
  std::vector<double> values;
  for (const ResidualTrack& track : tracks) {
    for (const auto& value : track) {
      if (value) values.push_back(*value);
    }
  }
  return values;
}

/// Mean of (value - centre)^power.
double moment(const std::vector<double>& values, double centre, int power) {
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value - centre, power);
  return sum / static_cast<double>(values.size());
}

/// Mean product of values `lag` frames apart; NaN where there are no pairs.
double covariance_at(std::span<const ResidualTrack> tracks, std::size_t lag) {
  double sum = 0.0;
  std::size_t pairs = 0;
  for (const ResidualTrack& track : tracks) {
    for (std::size_t i = lag; i < track.size(); ++i) {
      if (!track[i] || !track[i - lag]) continue;
      sum += *track[i] * *track[i - lag];
      ++pairs;
    }
  }
  return pairs == 0 ? kNaN : sum / static_cast<double>(pairs);
}

/// The tracks without those that are empty, each about its own mean.
std::vector<ResidualTrack> centred(std::span<const ResidualTrack> tracks) {
  std::vector<ResidualTrack> result;
  for (const ResidualTrack& track : tracks) {
    const std::vector<double> values = values_of({&track, 1});
    if (values.empty()) continue;
    const double centre = mean(values);
    result.push_back(track);
    for (auto& value : result.back()) {
      if (value) *value -= centre;
    }
  }
  return result;
}

}  // namespace

AxisStatistics axis_statistics(std::span<const ResidualTrack> tracks) {
  const std::vector<double> values = values_of(tracks);
  if (values.empty()) return {0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  const double centre = mean(values);
  const double variance = moment(values, centre, 2);
  const double middle = median(values);
  std::vector<double> distances = values;
  for (double& distance : distances) distance = std::abs(distance - middle);
  return {.count = values.size(),
          .mean = centre,
          .sd = std::sqrt(variance),
          .rms = std::sqrt(moment(values, 0.0, 2)),
          .median = middle,
          .robust_sd = kSdByMedianDistance * median(distances),
          .skewness = variance > 0.0 ? moment(values, centre, 3) / std::pow(variance, 1.5) : kNaN,
          .kurtosis = variance > 0.0 ? moment(values, centre, 4) / (variance * variance) : kNaN};
}

double spread_of_means(std::span<const ResidualTrack> tracks) {
  std::vector<double> means;
  for (const ResidualTrack& track : tracks) {
    const std::vector<double> values = values_of({&track, 1});
    if (!values.empty()) means.push_back(mean(values));
  }
  if (means.size() < 2) return kNaN;
  return std::sqrt(moment(means, mean(means), 2) * static_cast<double>(means.size()) /
                   static_cast<double>(means.size() - 1));
}

Autocorrelation autocorrelation(std::span<const ResidualTrack> tracks, std::size_t max_lag) {
  const std::vector<ResidualTrack> about_mean = centred(tracks);
  const std::size_t count = values_of(about_mean).size();
  Autocorrelation result{{1.0}, kNaN, kNaN, kNaN};
  const double variance = covariance_at(about_mean, 0);
  if (!(variance > 0.0)) return result;
  std::size_t longest = 0;
  for (const ResidualTrack& track : tracks) longest = std::max(longest, track.size());
  const std::size_t last = std::min(max_lag, longest / 2);
  double sum = 0.0;
  bool positive = true;
  for (std::size_t lag = 1; lag <= last; ++lag) {
    result.at_lag.push_back(covariance_at(about_mean, lag) / variance);
    if (lag % 2 == 0) continue;
    const double pair = result.at_lag[lag - 1] + result.at_lag[lag];
    positive = positive && pair > 0.0;
    if (positive) sum += pair;
    if (!positive && lag >= 100) break;
  }
  if (last >= 1) result.lag1 = result.at_lag[1];
  result.correlation_frames = std::max(1.0, 2.0 * sum - 1.0);
  result.effective_count = static_cast<double>(count) / result.correlation_frames;
  return result;
}

}  // namespace posemix
