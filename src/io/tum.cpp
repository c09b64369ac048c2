// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/tum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

constexpr std::array<std::string_view, 8> kTumColumns{"stamp", "tx", "ty", "tz",
                                                      "qx",    "qy", "qz", "qw"};

std::optional<SE3d> parse_pose(const PoseNumbers& numbers, const LineReader& reader,
                               const TumOptions& options) {
  const auto is_zero = [](double number) { return number == 0; };
  if (std::all_of(numbers.begin(), numbers.end(), is_zero)) {
    if (options.allow_misses) return std::nullopt;
    reader.fail("an all-zero pose", "a pose in every line (only detections may miss)");
  }
  SE3d pose = pose_from_numbers(numbers, reader);
  const bool zero_translation = std::all_of(numbers.begin(), numbers.begin() + 3, is_zero);
  if (options.zero_translation_is_miss && zero_translation) return std::nullopt;
  return pose;
}

StampedPose parse_frame(const LineReader& reader, const TumOptions& options) {
  const std::vector<std::string_view> words = split_words(reader.line());
  if (words.size() != kTumColumns.size()) {
    reader.fail(fmt::format("{} columns", words.size()), "8: stamp tx ty tz qx qy qz qw");
  }
  std::array<double, 8> numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = reader.number_from(words[i], kTumColumns[i]);
  }
  PoseNumbers pose;
  std::copy(numbers.begin() + 1, numbers.end(), pose.begin());
  return {numbers[0], parse_pose(pose, reader, options)};
}

void require_increasing_stamps(std::span<const StampedPose> frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double stamp = frames[i].stamp;
    if (!std::isfinite(stamp))
      throw InvalidInput(fmt::format("stamps[{}] is {}, expected a finite number", i, stamp));
    if (i == 0 || stamp > frames[i - 1].stamp) continue;
    throw InvalidInput(
        fmt::format("stamps[{}] is {} after {}, expected stamps that increase strictly", i, stamp,
                    frames[i - 1].stamp));
  }
}

}  // namespace

std::vector<StampedPose> parse_tum(std::string_view text, const std::string& name,
                                   const TumOptions& options) {
  std::vector<StampedPose> frames;
  LineReader reader(text, name);
  while (reader.next_content()) {
    const StampedPose frame = parse_frame(reader, options);
    if (!frames.empty() && !(frame.stamp > frames.back().stamp)) {
      reader.fail(fmt::format("stamp {} after stamp {}", frame.stamp, frames.back().stamp),
                  "strictly increasing stamps");
    }
    frames.push_back(frame);
  }
  if (frames.empty()) {
    throw InvalidInput(
        fmt::format("{}: got no poses, expected lines 'stamp tx ty tz qx qy qz qw'", name));
  }
  return frames;
}

std::vector<StampedPose> read_tum(const std::filesystem::path& path, const TumOptions& options) {
  return parse_tum(read_file(path), path.string(), options);
}

std::string format_tum(std::span<const StampedPose> frames, TumMisses misses) {
  require_increasing_stamps(frames);
  std::string text;
  for (const StampedPose& frame : frames) {
    if (frame.pose) {
      text += fmt::format("{} {}\n", frame.stamp, format_pose(*frame.pose));
    } else if (misses == TumMisses::write_zeros) {
      text += fmt::format("{} 0 0 0 0 0 0 0\n", frame.stamp);
    }
  }
  return text;
}

}  // namespace posemix
