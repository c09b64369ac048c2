// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace posemix {
namespace {

struct TrackSums {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
};

TrackSums sums_of(const ResidualTrack& track) {
  TrackSums sums;
  for (const auto& value : track) {
    if (!value) continue;
    sums.count += 1.0;
    sums.sum += *value;
    sums.squares += *value * *value;
  }
  return sums;
}

/// Mean number of successive ones. Missing values are skipped, and runs that the beginning or the
/// end of a recording cuts off count with the length that is left.
double mean_run(std::span<const ResidualTrack> tracks) {
  double ones = 0.0;
  double runs = 0.0;
  for (const ResidualTrack& track : tracks) {
    bool in_run = false;
    for (const auto& value : track) {
      if (!value) continue;
      const bool one = *value > 0.5;
      ones += one ? 1.0 : 0.0;
      runs += one && !in_run ? 1.0 : 0.0;
      in_run = one;
    }
  }
  return runs > 0.0 ? ones / runs : 0.0;
}

/// Residuals of inliers, raw and whitened, and the indicator of outliers.
struct Tracks {
  std::array<std::vector<ResidualTrack>, 6> raw;
  std::vector<ResidualTrack> white;  ///< the whitened residuals of all axes
  std::array<std::vector<ResidualTrack>, 6> white_axes;
  std::vector<ResidualTrack> outlier;
  std::size_t inliers = 0;
};

void add_track(const NoiseTrack& track, const NoiseComponent& inlier, const Matrix6d& whitening,
               Tracks& result) {
  const ResidualTrack empty(track.size());
  for (std::size_t axis = 0; axis < 6; ++axis) {
    result.raw[axis].push_back(empty);
    result.white_axes[axis].push_back(empty);
  }
  result.outlier.push_back(empty);
  for (std::size_t frame = 0; frame < track.size(); ++frame) {
    if (!track[frame]) continue;
    const Vector6d n =
        detection_residual(track[frame]->truth, track[frame]->detected, inlier.frame);
    const Vector6d white = whitening * n;
    const bool out = white.squaredNorm() >= kInlierGate;
    result.outlier.back()[frame] = out ? 1.0 : 0.0;
    if (out) continue;
    ++result.inliers;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      result.raw[axis].back()[frame] = n[static_cast<Eigen::Index>(axis)];
      result.white_axes[axis].back()[frame] = white[static_cast<Eigen::Index>(axis)];
    }
  }
}

/// The values less `centre`.
std::vector<ResidualTrack> about(std::vector<ResidualTrack> tracks, double centre) {
  for (ResidualTrack& track : tracks) {
    for (auto& value : track) {
      if (value) *value -= centre;
    }
  }
  return tracks;
}

}  // namespace

DependentFrames dependent_frames(std::span<const ResidualTrack> tracks) {
  double squared_sums = 0.0;
  double squares = 0.0;
  for (const ResidualTrack& track : tracks) {
    const TrackSums sums = sums_of(track);
    squared_sums += sums.sum * sums.sum;
    squares += sums.squares;
  }
  const double ratio =
      squares > 0.0 ? squared_sums / squares : std::numeric_limits<double>::quiet_NaN();
  return {std::isnan(ratio) ? ratio : std::max(1.0, ratio),
          autocorrelation(tracks).correlation_frames};
}

double bias_sd(std::span<const ResidualTrack> tracks, double within) {
  constexpr double kFewest = 10.0;
  double scatter = 0.0;
  double count = 0.0;
  std::vector<TrackSums> recordings;
  for (const ResidualTrack& track : tracks) {
    const TrackSums sums = sums_of(track);
    if (sums.count < kFewest) continue;
    recordings.push_back(sums);
    scatter += sums.squares - sums.sum * sums.sum / sums.count;
    count += sums.count - 1.0;
  }
  if (recordings.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (const TrackSums& sums : recordings) {
    const double mean = sums.sum / sums.count;
    sum += mean * mean - scatter / count * within / sums.count;
  }
  return std::sqrt(std::max(0.0, sum / static_cast<double>(recordings.size())));
}

NoiseCorrelation noise_correlation(std::span<const NoiseTrack> tracks,
                                   const NoiseComponent& inlier) {
  const Eigen::LLT<Matrix6d> factor(inlier.covariance);
  const Matrix6d whitening = factor.matrixL().solve(Matrix6d::Identity());
  Tracks all;
  for (const NoiseTrack& track : tracks) add_track(track, inlier, whitening, all);
  NoiseCorrelation result;
  result.inliers = all.inliers;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto& white = all.white_axes[axis];
    all.white.insert(all.white.end(), white.begin(), white.end());
    result.axes[axis] = dependent_frames(white);
    result.bias_sd[static_cast<Eigen::Index>(axis)] =
        bias_sd(all.raw[axis], result.axes[axis].within);
  }
  result.inlier = dependent_frames(all.white);
  const AxisStatistics indicator = axis_statistics(all.outlier);
  result.outlier_share = indicator.mean;
  result.outlier_run = mean_run(all.outlier);
  result.outlier = dependent_frames(about(all.outlier, indicator.mean));
  return result;
}

}  // namespace posemix
