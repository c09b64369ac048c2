// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "anees.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "posemix/base/statistics.hpp"
#include "table_reader.hpp"

namespace posemix {
namespace {

constexpr double kLow = 0.5;
constexpr double kHigh = 2.0;

/// Poses and their columns.
constexpr std::array<std::pair<const char*, const char*>, 6> kPoseColumns{
    {{"relative", "relative_anees"},
     {"relative, right mode", "right_mode_anees"},
     {"world", "world_anees"},
     {"camera", "camera_anees"},
     {"camera rotation", "camera_rotation_anees"},
     {"camera position", "camera_position_anees"}}};

std::vector<double> values_of(const TableReader& table, const std::string& detector,
                              const std::string& method, std::string_view column) {
  std::vector<double> values;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.text(i, "detector") != detector || table.text(i, "method") != method) continue;
    const double value = table.number(i, column);
    if (!std::isnan(value)) values.push_back(value);
  }
  return values;
}

}  // namespace

StudyTable summarise_anees(const StudyTable& rows) {
  const TableReader table(rows);
  StudyTable summary(
      {"detector", "method", "pose", "rows", "median", "mean", "worst", "share_half_to_two"});
  for (const std::string& detector : table.names("detector")) {
    for (const std::string& method : table.names("method")) {
      for (const auto& [pose, column] : kPoseColumns) {
        const std::vector<double> values = values_of(table, detector, method, column);
        if (values.empty()) continue;
        const auto within = std::count_if(values.begin(), values.end(), [](double value) {
          return kLow <= value && value <= kHigh;
        });
        summary.add({detector, method, pose, static_cast<std::int64_t>(values.size()),
                     median(values), mean(values), *std::max_element(values.begin(), values.end()),
                     static_cast<double>(within) / static_cast<double>(values.size())});
      }
    }
  }
  return summary;
}

}  // namespace posemix
