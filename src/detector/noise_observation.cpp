// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_observation.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "detector/noise_rows.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/limits.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

void check_stamps(std::span<const double> stamps_s, std::size_t frames) {
  if (!stamps_s.empty() && stamps_s.size() != frames) {
    throw InvalidInput(fmt::format("noise model: {} stamps of {} frames, expected as many",
                                   stamps_s.size(), frames));
  }
  for (std::size_t frame = 0; frame < stamps_s.size(); ++frame)
    if (!kStamp.contains(stamps_s[frame]))
      kStamp.check(stamps_s[frame], fmt::format("noise model: stamp of frame {}", frame));
  for (std::size_t frame = 1; frame < stamps_s.size(); ++frame) {
    if (!(stamps_s[frame] < stamps_s[frame - 1])) continue;
    throw InvalidInput(
        fmt::format("noise model: the stamp {} s of frame {} follows {} s, expected an order in "
                    "which stamps do not decrease",
                    stamps_s[frame], frame, stamps_s[frame - 1]));
  }
}

}  // namespace

NoiseTrack noise_track(std::span<const std::optional<SE3d>> truth,
                       std::span<const std::optional<SE3d>> detected, std::size_t recording,
                       std::span<const double> stamps_s) {
  if (truth.size() != detected.size()) {
    throw InvalidInput(fmt::format("noise model: {} true poses and {} detections, expected as many",
                                   truth.size(), detected.size()));
  }
  check_stamps(stamps_s, truth.size());
  NoiseTrack track;
  std::optional<SE3d> previous;
  double path = 0.0;
  for (std::size_t frame = 0; frame < truth.size(); ++frame) {
    if (!truth[frame]) continue;
    if (previous) path += view_angle(*previous, *truth[frame]);
    previous = truth[frame];
    track.emplace_back();
    if (!detected[frame]) continue;
    track.back() = NoiseObservation{
        .truth = *truth[frame],
        .detected = *detected[frame],
        .recording = recording,
        .stamp_s = stamps_s.empty() ? std::numeric_limits<double>::quiet_NaN() : stamps_s[frame],
        .view_path_rad = path};
  }
  return track;
}

double seconds_per_frame(std::span<const NoiseTrack> tracks) {
  std::vector<double> spacings;
  for (const NoiseTrack& track : tracks) {
    std::optional<std::size_t> first;
    std::size_t last = 0;
    for (std::size_t frame = 0; frame < track.size(); ++frame) {
      if (!track[frame]) continue;
      if (!first) first = frame;
      last = frame;
    }
    if (!first || last == *first) continue;
    const double spacing =
        (track[last]->stamp_s - track[*first]->stamp_s) / static_cast<double>(last - *first);
    if (std::isfinite(spacing)) spacings.push_back(spacing);
  }
  return spacings.empty() ? std::numeric_limits<double>::quiet_NaN() : median(spacings);
}

std::vector<NoiseObservation> observations_of(std::span<const NoiseTrack> tracks) {
  std::vector<NoiseObservation> observations;
  for (const NoiseTrack& track : tracks) {
    for (const auto& seen : track) {
      if (seen) observations.push_back(*seen);
    }
  }
  return observations;
}

Vector6d detection_residual(const SE3d& truth, const SE3d& detected, NoiseFrame frame) {
  return internal::residual_turn(truth, frame) * (truth.inverse() * detected).log();
}

std::array<std::vector<ResidualTrack>, 6> residual_tracks(std::span<const NoiseTrack> tracks,
                                                          NoiseFrame frame) {
  std::array<std::vector<ResidualTrack>, 6> axes;
  for (const NoiseTrack& track : tracks) {
    for (auto& axis : axes) axis.emplace_back(track.size());
    for (std::size_t at = 0; at < track.size(); ++at) {
      if (!track[at]) continue;
      const Vector6d n = detection_residual(track[at]->truth, track[at]->detected, frame);
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const double value = n[static_cast<Eigen::Index>(axis)];
        axes[axis].back()[at] = axis < 3 ? degrees(value) : value;
      }
    }
  }
  return axes;
}

}  // namespace posemix
