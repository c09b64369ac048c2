// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "sequence_parts.hpp"

/// The stamps of a recording are seconds of one clock.
namespace posemix::internal {
namespace {

/// Stamps further from all others are of another clock or in another unit [s].
constexpr double kLongestPause = 1e7;
/// So far from all odometry observations may be [s].
constexpr double kLongestWithoutOdometry = 1e5;

struct Seen {
  double stamp = 0.0;
  const ObservationFile* file = nullptr;
  std::size_t index = 0;
};

/// All observations by time.
std::vector<Seen> by_time(const std::vector<ObservationFile>& files) {
  std::vector<Seen> all;
  for (const ObservationFile& file : files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i)
      all.push_back({file.observations[i].stamp_s, &file, i});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Seen& a, const Seen& b) { return a.stamp < b.stamp; });
  return all;
}

std::string place_of(const Seen& seen) { return seen.file->place(seen.index); }

/// Of two parts with a pause between them the one with fewer stamps is wrong.
void require_short_pauses(const std::vector<Seen>& all) {
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k].stamp - all[k - 1].stamp <= kLongestPause) continue;
    const bool is_before = k < all.size() - k;
    const Seen& wrong = all[is_before ? k - 1 : k];
    const Seen& near = all[is_before ? k : k - 1];
    throw InvalidInput(fmt::format(
        "{}: got stamp_s = {}, expected seconds of the clock of the others, within {:g} s of the "
        "nearest, which is {} ({})",
        place_of(wrong), wrong.stamp, kLongestPause, near.stamp, place_of(near)));
  }
}

}  // namespace

void require_one_clock(const ObservedRecording& observed, const CameraFiles& camera) {
  const std::vector<Seen> all = by_time(observed.files);
  if (!camera.odometry || camera.odometry->poses.empty() || all.empty())
    return require_short_pauses(all);
  const auto ends =
      std::minmax_element(camera.odometry->poses.begin(), camera.odometry->poses.end(),
                          [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  const auto first = ends.first;
  const auto last = ends.second;
  const bool any = std::any_of(all.begin(), all.end(), [&](const Seen& seen) {
    return seen.stamp >= first->stamp && seen.stamp <= last->stamp;
  });
  if (!any) {
    const ObservationFile& file = observed.files.front();
    throw InvalidInput(
        fmt::format("{}: goes from stamp {} s to {} s, expected stamps of the same clock as those "
                    "of {}, the first of which is {} s",
                    camera.odometry->name, first->stamp, last->stamp, file.name,
                    file.observations.front().stamp_s));
  }
  for (const Seen& seen : all) {
    if (seen.stamp >= first->stamp - kLongestWithoutOdometry &&
        seen.stamp <= last->stamp + kLongestWithoutOdometry)
      continue;
    throw InvalidInput(
        fmt::format("{}: got stamp_s = {}, expected seconds of the clock of {}, which goes from {} "
                    "s to {} s",
                    place_of(seen), seen.stamp, camera.odometry->name, first->stamp, last->stamp));
  }
}

}  // namespace posemix::internal
