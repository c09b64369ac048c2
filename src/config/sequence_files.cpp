// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

namespace posemix::internal {
namespace {

namespace fs = std::filesystem;

constexpr double kStampTolerance = 1e-3;

double tolerance_of(const std::vector<double>& stamps) {
  double tolerance = kStampTolerance;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    tolerance = std::min(tolerance, 0.5 * (stamps[i] - stamps[i - 1]));
  }
  return tolerance;
}

std::vector<double> stamps_of(const std::vector<std::int64_t>& numbers, double period_s) {
  std::vector<double> stamps;
  stamps.reserve(numbers.size());
  for (const std::int64_t number : numbers)
    stamps.push_back(static_cast<double>(number) * period_s);
  return stamps;
}

/// A reader at a record of a TUM file, for its errors.
LineReader reader_at(std::string_view text, const std::string& name, std::size_t record) {
  LineReader reader(text, name);
  for (std::size_t i = 0; i <= record; ++i) reader.next_content();
  return reader;
}

}  // namespace

fs::path FileFinder::find(const TomlTable& table, std::string_view key) const {
  const fs::path named = table.get_string(key);
  if (named.empty()) table.fail(key, "is empty, expected the path of a file");
  std::vector<std::string> places;
  for (const fs::path& folder : folders_) {
    for (const std::string& root : roots_) {
      fs::path place = (folder / root / named).lexically_normal();
      if (is_there(place)) {
        table.note_input(place);
        return place;
      }
      const std::string text = in_quotes(place.string(), 300);
      if (std::find(places.begin(), places.end(), text) == places.end()) places.push_back(text);
    }
  }
  table.fail(key, fmt::format("names {}, which is not there; looked for {}",
                              in_quotes(named.string(), 200), fmt::join(places, ", ")));
}

const DatasetScene& FileFinder::scene(const TomlTable& table) const {
  const bool bop = table.has("bop_dataset");
  const fs::path dataset = find(table, bop ? "bop_dataset" : "ycb_video");
  const std::string part =
      bop ? table.get_string_or("split", "test") : table.get_string("sequence");
  const std::int64_t number = bop ? table.get_integer("scene", kAtLeastZero) : 0;
  const bool inside = !part.empty() && part.find("..") == std::string::npos && part[0] != '/';
  if (!inside) table.fail(bop ? "split" : "sequence", "is no name of a folder");
  const std::string key = fmt::format("{}\n{}\n{}", dataset.string(), part, number);
  const auto known = scenes_->find(key);
  if (known != scenes_->end()) return known->second;
  return scenes_
      ->emplace(key, located(table, bop ? "bop_dataset" : "ycb_video",
                             [&] {
                               return bop ? read_bop_scene(dataset, part, number)
                                          : read_ycb_video_scene(dataset, part);
                             }))
      .first->second;
}

std::int64_t read_first_frame(const TomlTable& table, const std::string& name, std::int64_t least) {
  const std::int64_t first = table.get_integer_or("first_frame", 1, kAtLeastZero);
  if (least >= first) return first;
  table.fail("first_frame", fmt::format("is {}, but {} has frame {}", first, name, least));
}

StampedFile read_stamped(const TomlTable& table, std::string_view key, const FileFinder& files,
                         const TumOptions& options) {
  const fs::path path = files.find(table, key);
  const std::string text = read_file(path);
  StampedFile file{path.string(), parse_tum(text, path.string(), options)};
  for (std::size_t i = 0; i < file.poses.size(); ++i) {
    const StampedPose& frame = file.poses[i];
    if (!wrong_stamp(frame.stamp).empty())
      reader_at(text, file.name, i)
          .fail(fmt::format("stamp {}", frame.stamp), wrong_stamp(frame.stamp));
    if (!frame.pose) continue;
    const double farthest = frame.pose->translation().cwiseAbs().maxCoeff();
    if (!wrong_position(farthest).empty())
      reader_at(text, file.name, i)
          .fail(fmt::format("a position of {:g} m", farthest), wrong_position(farthest));
  }
  return file;
}

Timeline::Timeline(std::vector<double> stamps, std::string source)
    : stamps_(std::move(stamps)), tolerance_(tolerance_of(stamps_)), source_(std::move(source)) {}

Timeline::Timeline(std::vector<std::int64_t> numbers, double period_s, std::string source)
    : stamps_(stamps_of(numbers, period_s)),
      numbers_(std::move(numbers)),
      tolerance_(tolerance_of(stamps_)),
      source_(std::move(source)) {}

std::optional<std::size_t> Timeline::at_stamp(double stamp) const {
  const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (auto it = after == stamps_.begin() ? after : after - 1; it != stamps_.end() && it <= after;
       ++it) {
    const double distance = std::abs(*it - stamp);
    if (distance <= tolerance_ && distance < least) {
      least = distance;
      nearest = static_cast<std::size_t>(it - stamps_.begin());
    }
  }
  return nearest;
}

std::optional<std::size_t> Timeline::at_number(std::int64_t number) const {
  if (!numbers_) {
    const bool inside = number >= 0 && number < static_cast<std::int64_t>(stamps_.size());
    return inside ? std::optional(static_cast<std::size_t>(number)) : std::nullopt;
  }
  const auto found = std::lower_bound(numbers_->begin(), numbers_->end(), number);
  if (found == numbers_->end() || *found != number) return std::nullopt;
  return static_cast<std::size_t>(found - numbers_->begin());
}

std::size_t Timeline::frame_of(std::int64_t number, const std::string& file) const {
  const auto frame = at_number(number);
  if (frame) return *frame;
  throw InvalidInput(
      fmt::format("{}: got a detection {} frames after the first, where {} has {} frames", file,
                  number, source_, stamps_.size()));
}

Poses Timeline::select(const StampedFile& file) const {
  Poses poses(stamps_.size());
  bool any = false;
  for (const StampedPose& record : file.poses) {
    const auto frame = at_stamp(record.stamp);
    if (!frame) continue;
    poses[*frame] = record.pose;
    any = true;
  }
  if (!any) {
    throw InvalidInput(fmt::format("{}: no stamp fits a frame, expected stamps between {} and {} s",
                                   file.name, stamps_.front(), stamps_.back()));
  }
  return poses;
}

}  // namespace posemix::internal
