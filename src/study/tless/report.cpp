// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "posemix/base/statistics.hpp"
#include "study/engine/table.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// Columns of a row in the order of its keys.
Cell cell_of(const Json& value) {
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  return {};
}

StudyTable tless_table(const std::vector<Json>& rows) {
  std::vector<std::string> columns;
  for (const auto& entry : rows.front().items()) columns.push_back(entry.key());
  StudyTable table(columns);
  for (const Json& row : rows) {
    std::vector<Cell> cells;
    for (const auto& entry : row.items()) cells.push_back(cell_of(entry.value()));
    table.add(std::move(cells));
  }
  return table;
}

std::vector<Json> with_symmetries(const std::vector<Json>& rows, const std::string& symmetries) {
  std::vector<Json> selected;
  for (const Json& row : rows) {
    if (row.at("symmetries") == symmetries) selected.push_back(row);
  }
  return selected;
}

std::int64_t sum_of(const std::vector<Json>& rows, const std::string& key) {
  std::int64_t sum = 0;
  for (const Json& row : rows) sum += row.at(key).get<std::int64_t>();
  return sum;
}

Cell ratio(std::int64_t part, std::int64_t whole) {
  if (whole == 0) return {};
  return static_cast<double>(part) / static_cast<double>(whole);
}

std::vector<double> known(const std::vector<Json>& rows, const std::string& key) {
  std::vector<double> values;
  for (const Json& row : rows) {
    if (!row.at(key).is_null()) values.push_back(row.at(key).get<double>());
  }
  return values;
}

Cell median_of(const std::vector<Json>& rows, const std::string& key) {
  const std::vector<double> values = known(rows, key);
  return values.empty() ? Cell() : Cell(median(values));
}

/// Root mean square over scenes, which have equal numbers of frames.
Cell rms_of(const std::vector<Json>& rows, const std::string& key) {
  const std::vector<double> values = known(rows, key);
  if (values.empty()) return {};
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

using Figures = std::vector<std::pair<std::string, Cell>>;

/// Summary figures: shares over all instances and frames, medians over the instances.
Figures figures_of(const std::vector<Json>& instances, const std::vector<Json>& scenes) {
  const std::int64_t frames = sum_of(instances, "frames");
  const auto count = static_cast<std::int64_t>(instances.size());
  Figures figures{{"scenes", static_cast<std::int64_t>(scenes.size())},
                  {"instances", count},
                  {"views_of_instances", frames}};
  const auto add = [&](const std::string& prefix, std::int64_t whole) {
    figures.emplace_back(prefix + "found_share", ratio(sum_of(instances, prefix + "found"), whole));
    figures.emplace_back(prefix + "within_share",
                         ratio(sum_of(instances, prefix + "within"), whole));
    for (const char* name : {"rotation_deg", "translation_m", "mssd_m"})
      figures.emplace_back(prefix + name, median_of(instances, prefix + name));
  };
  add("", frames);
  add("detection_", frames);
  add("paired_", frames);
  add("paired_detection_", frames);
  add("end_", count);
  for (const char* name : {"detections", "confirmed", "false_confirmed", "recycled"})
    figures.emplace_back(name, sum_of(scenes, name));
  figures.emplace_back("flip_share", ratio(sum_of(scenes, "flips"), sum_of(scenes, "steps")));
  figures.emplace_back("axis_turn_share",
                       ratio(sum_of(scenes, "axis_turns"), sum_of(scenes, "axis_steps")));
  for (const char* name :
       {"camera_rotation_rmse_deg", "camera_position_rmse_m",
        "synthetic_odometry_rotation_rmse_deg", "synthetic_odometry_position_rmse_m"})
    figures.emplace_back(name, rms_of(scenes, name));
  return figures;
}

}  // namespace

StudyReport report_tless(std::span<const std::string> results) {
  std::vector<Json> instances;
  std::vector<Json> scenes;
  for (const std::string& text : results) {
    const Json result = Json::parse(text);
    for (const Json& row : result.at("instances")) instances.push_back(row);
    scenes.push_back(result.at("scene"));
  }
  const Figures declared =
      figures_of(with_symmetries(instances, "declared"), with_symmetries(scenes, "declared"));
  const Figures none =
      figures_of(with_symmetries(instances, "none"), with_symmetries(scenes, "none"));
  StudyTable summary({"figure", "declared", "none"});
  for (std::size_t i = 0; i < declared.size(); ++i)
    summary.add({declared[i].first, declared[i].second, none[i].second});

  const StudyTable rows = tless_table(instances);
  StudyReport report;
  report.files = {{"study.json", format_study("tless", rows, summary)},
                  {"tless.csv", rows.csv()},
                  {"scenes.csv", tless_table(scenes).csv()},
                  {"summary.csv", summary.csv()}};
  report.summary = summary.text(4);
  return report;
}

}  // namespace posemix
