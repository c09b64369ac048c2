// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_observation.hpp"

#include <fmt/format.h>

#include "detector/noise_rows.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"

namespace posemix {

NoiseTrack noise_track(std::span<const std::optional<SE3d>> truth,
                       std::span<const std::optional<SE3d>> detected, std::size_t recording) {
  if (truth.size() != detected.size()) {
    throw InvalidInput(fmt::format("noise model: {} true poses and {} detections, expected as many",
                                   truth.size(), detected.size()));
  }
  NoiseTrack track;
  for (std::size_t frame = 0; frame < truth.size(); ++frame) {
    if (!truth[frame]) continue;
    track.emplace_back();
    if (detected[frame])
      track.back() = NoiseObservation{*truth[frame], *detected[frame], recording};
  }
  return track;
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
