// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/object_poses.hpp"

#include <array>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

constexpr std::array<std::string_view, 7> kObjectPoseColumns{"tx", "ty", "tz", "qx",
                                                             "qy", "qz", "qw"};

SE3d parse_pose(const std::vector<std::string_view>& words, const LineReader& reader) {
  PoseNumbers numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = reader.number_from(words[i + 1], kObjectPoseColumns[i]);
  }
  return pose_from_numbers(numbers, reader);
}

}  // namespace

std::map<std::string, SE3d> parse_object_poses(std::string_view text, const std::string& name) {
  std::map<std::string, SE3d> poses;
  LineReader reader(text, name);
  while (reader.next_content()) {
    const std::vector<std::string_view> words = split_words(reader.line());
    if (words.size() < kObjectPoseColumns.size() + 1) {
      reader.fail(fmt::format("{} columns", words.size()), "8: id tx ty tz qx qy qz qw");
    }
    for (const std::string_view word : std::span(words).subspan(kObjectPoseColumns.size() + 1)) {
      reader.number_from(word, "a column after qw");
    }
    const bool fresh = poses.emplace(std::string(words[0]), parse_pose(words, reader)).second;
    if (!fresh)
      reader.fail(fmt::format("object {} again", in_quotes(words[0])), "one line per object");
  }
  if (poses.empty()) {
    throw InvalidInput(
        fmt::format("{}: got no poses, expected lines 'id tx ty tz qx qy qz qw'", name));
  }
  return poses;
}

std::map<std::string, SE3d> read_object_poses(const std::filesystem::path& path) {
  return parse_object_poses(read_file(path), path.string());
}

std::string format_object_poses(const std::map<std::string, SE3d>& poses) {
  std::string text;
  for (const auto& [id, pose] : poses) text += fmt::format("{} {}\n", id, format_pose(pose));
  return text;
}

}  // namespace posemix
