// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/bop.hpp"

#include <array>

#include <fmt/format.h>
#include <Eigen/Core>

#include "observation_numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix {
namespace {

using namespace internal;

constexpr std::string_view kHeader = "scene_id,im_id,obj_id,score,R,t,time";
constexpr std::size_t kFields = 7;
constexpr double kMetresPerMillimetre = 1e-3;

struct RawRow {
  std::int64_t scene, image, object;
  double score;
  Eigen::Matrix4d pose;
};

template <std::size_t N>
std::array<double, N> parse_numbers(std::string_view field, std::string_view column,
                                    const LineReader& reader) {
  const std::vector<std::string_view> words = split_words(field);
  if (words.size() != N) {
    reader.fail(fmt::format("{} numbers in {}", words.size(), column), fmt::format("{}", N));
  }
  std::array<double, N> numbers;
  for (std::size_t i = 0; i < N; ++i) numbers[i] = reader.number_from(words[i], column);
  return numbers;
}

RawRow parse_row(const LineReader& reader) {
  const std::vector<std::string_view> fields = split_fields(reader.line(), ',');
  if (fields.size() != kFields) {
    reader.fail(fmt::format("{} columns", fields.size()), fmt::format("7: {}", kHeader));
  }
  RawRow row;
  row.scene = reader.index_from(trimmed(fields[0]), "scene_id");
  row.image = reader.index_from(trimmed(fields[1]), "im_id");
  row.object = reader.index_from(trimmed(fields[2]), "obj_id");
  row.score = reader.number_from(trimmed(fields[3]), "score");
  const auto rotation = parse_numbers<9>(fields[4], "R", reader);
  const auto translation_mm = parse_numbers<3>(fields[5], "t", reader);
  for (const double coordinate : translation_mm) {
    if (!wrong_position(coordinate * kMetresPerMillimetre).empty())
      reader.fail(fmt::format("t = {} with {:g} mm", in_quotes(trimmed(fields[5])), coordinate),
                  "millimetres, at most 1e+11");
  }
  row.pose.setIdentity();
  row.pose.topLeftCorner<3, 3>() = Eigen::Matrix3d(rotation.data()).transpose();
  row.pose.topRightCorner<3, 1>() = Eigen::Vector3d(translation_mm.data()) * kMetresPerMillimetre;
  reader.number_from(trimmed(fields[6]), "time");
  return row;
}

/// Calls `take` for every row except the header.
template <typename Take>
void for_each_row(std::string_view text, const std::string& name, Take&& take) {
  LineReader reader(text, name);
  while (reader.next()) {
    if (trimmed(reader.line()).empty()) continue;
    if (reader.number() == 1 && trimmed(reader.line()) == kHeader) continue;
    const RawRow row = parse_row(reader);
    take(row, fmt::format("{}:{}", name, reader.number()));
  }
}

}  // namespace

BopDetections parse_bop(std::string_view text, const std::string& name, BopSelection selection) {
  BopDetections detections;
  for_each_row(text, name, [&](const RawRow& row, const std::string& where) {
    if (row.scene != selection.scene || row.object != selection.object) return;
    detections[row.image].push_back({row.score, pose_from_matrix(row.pose, where)});
  });
  if (detections.empty()) {
    throw InvalidInput(
        fmt::format("{}: got no row of scene {} and object {}, expected at least one", name,
                    selection.scene, selection.object));
  }
  return detections;
}

BopDetections read_bop(const std::filesystem::path& path, BopSelection selection) {
  return parse_bop(read_file(path), path.string(), selection);
}

std::vector<BopRow> parse_bop_rows(std::string_view text, const std::string& name) {
  std::vector<BopRow> rows;
  for_each_row(text, name, [&](const RawRow& row, const std::string& where) {
    rows.push_back(
        {row.scene, row.image, row.object, row.score, pose_from_matrix(row.pose, where)});
  });
  if (rows.empty()) throw InvalidInput(fmt::format("{}: got no row, expected at least one", name));
  return rows;
}

std::vector<BopRow> read_bop_rows(const std::filesystem::path& path) {
  return parse_bop_rows(read_file(path), path.string());
}

}  // namespace posemix
