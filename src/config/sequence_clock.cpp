// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <string_view>

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

/// A stamp of an observation, or of a list of frames or images.
struct Seen {
  double stamp = 0.0;
  const ObservationFile* file = nullptr;
  std::size_t index = 0;
  const PlacedStamp* listed = nullptr;
};

/// All stamps but the odometry's, by time.
std::vector<Seen> by_time(const std::vector<ObservationFile>& files, const CameraFiles& camera) {
  std::vector<Seen> all;
  for (const ObservationFile& file : files) {
    for (std::size_t i = 0; i < file.observations.size(); ++i)
      all.push_back({.stamp = file.observations[i].stamp_s, .file = &file, .index = i});
  }
  for (const PlacedStamp& one : camera.stamps) all.push_back({.stamp = one.stamp, .listed = &one});
  if (camera.images) {
    for (const ImageList::Image& image : camera.images->images)
      all.push_back({.stamp = image.at.stamp, .listed = &image.at});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Seen& a, const Seen& b) { return a.stamp < b.stamp; });
  return all;
}

std::string place_of(const Seen& seen) {
  return seen.listed != nullptr ? seen.listed->place : seen.file->place(seen.index);
}

std::string_view name_of(const Seen& seen) { return seen.listed != nullptr ? "stamp" : "stamp_s"; }

/// Of two parts with a pause between them the one with fewer stamps is wrong.
void require_short_pauses(const std::vector<Seen>& all) {
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k].stamp - all[k - 1].stamp <= kLongestPause) continue;
    const bool is_before = k < all.size() - k;
    const Seen& wrong = all[is_before ? k - 1 : k];
    const Seen& near = all[is_before ? k : k - 1];
    throw InvalidInput(fmt::format(
        "{}: got {} = {}, expected seconds of the clock of the others, within {:g} s of the "
        "nearest, which is {} ({})",
        place_of(wrong), name_of(wrong), wrong.stamp, kLongestPause, near.stamp, place_of(near)));
  }
}

void require_near_odometry(const std::vector<Seen>& all, const StampedFile& odometry) {
  const auto [first, last] =
      std::minmax_element(odometry.poses.begin(), odometry.poses.end(),
                          [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  const double begin = first->stamp;
  const double end = last->stamp;
  const bool any = std::any_of(all.begin(), all.end(), [&](const Seen& seen) {
    return seen.stamp >= begin && seen.stamp <= end;
  });
  if (!any) {
    throw InvalidInput(
        fmt::format("{}: goes from stamp {} s to {} s, expected stamps of the same clock as that "
                    "of {}, which is {} s",
                    odometry.name, begin, end, place_of(all.front()), all.front().stamp));
  }
  for (const Seen& seen : all) {
    if (seen.stamp >= begin - kLongestWithoutOdometry &&
        seen.stamp <= end + kLongestWithoutOdometry)
      continue;
    throw InvalidInput(
        fmt::format("{}: got {} = {}, expected seconds of the clock of {}, which goes from {} s to "
                    "{} s",
                    place_of(seen), name_of(seen), seen.stamp, odometry.name, begin, end));
  }
}

}  // namespace

void require_one_clock(const ObservedRecording& observed, const CameraFiles& camera) {
  // Without observations every listed stamp has to be that of a frame.
  if (observed.files.empty()) return;
  const std::vector<Seen> all = by_time(observed.files, camera);
  if (!camera.odometry || camera.odometry->poses.empty() || all.empty())
    return require_short_pauses(all);
  require_near_odometry(all, *camera.odometry);
}

}  // namespace posemix::internal
