// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "posemix/base/statistics.hpp"
#include "posemix/draw/chart.hpp"
#include "study/engine/table.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;
using FiducialRows = std::vector<Json>;

Cell fiducial_cell(const Json& value) {
  if (value.is_boolean()) return static_cast<std::int64_t>(value.get<bool>());
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  return {};
}

StudyTable fiducial_table(const FiducialRows& rows, const std::vector<std::string>& columns) {
  StudyTable table(columns);
  for (const Json& row : rows) {
    std::vector<Cell> cells;
    cells.reserve(columns.size());
    for (const std::string& column : columns) cells.push_back(fiducial_cell(row.at(column)));
    table.add(std::move(cells));
  }
  return table;
}

/// All columns of the first row, in their order.
StudyTable fiducial_table(const FiducialRows& rows) {
  std::vector<std::string> columns;
  if (!rows.empty()) {
    for (const auto& entry : rows.front().items()) columns.push_back(entry.key());
  }
  return fiducial_table(rows, columns);
}

/// The camera's distance to the reference over time, a chart for every recording.
std::string draw_fiducial_paths(const FiducialRows& paths) {
  std::vector<Chart> charts;
  for (const Json& path : paths) {
    const std::string recording = path.at("head").at("recording");
    if (charts.empty() || charts.back().title != recording) {
      charts.push_back(
          {.title = recording, .x_label = "time [s]", .y_label = "distance [m]", .log_y = true});
    }
    charts.back().series.push_back({.label = path.at("head").at("input"),
                                    .x = path.at("seconds").get<std::vector<double>>(),
                                    .y = path.at("distances_m").get<std::vector<double>>()});
  }
  return draw_charts("Camera against the reference", charts, charts.size() > 1 ? 2 : 1);
}

constexpr std::string_view kFiducialsQuestion =
    "Does SLAM on square tags gain when a filter gets both poses that the corners of a tag allow, "
    "and not one?";

/// The errors of the camera by input, as medians over the recordings.
std::vector<std::string> fiducials_notes(const FiducialRows& rows) {
  std::map<std::string, std::vector<double>> errors;
  for (const Json& row : rows) {
    if (row.at("camera_rms_m").is_number())
      errors[row.at("input")].push_back(row.at("camera_rms_m"));
  }
  std::string note = "Error of the camera (rms), median over the recordings [mm]:";
  for (const auto& [input, values] : errors) {
    note += fmt::format("{} {} {:.3g}", input == errors.begin()->first ? "" : ",", input,
                        1e3 * median(values));
  }
  if (errors.empty()) return {};
  return {note + "."};
}

}  // namespace

StudyReport report_fiducials(std::span<const std::string> results) {
  FiducialRows rows, tags, timing, paths;
  for (const std::string& text : results) {
    const Json result = Json::parse(text);
    rows.push_back(result.at("row"));
    for (const Json& row : result.at("tags")) tags.push_back(row);
    timing.push_back(result.at("timing"));
    paths.push_back(result.at("path"));
  }
  const StudyTable table = fiducial_table(rows);
  StudyReport report;
  report.notes = fiducials_notes(rows);
  report.files = {
      {"study.json", format_study({"fiducials", kFiducialsQuestion, report.notes}, table)},
      {"fiducials.csv", table.csv()},
      {"tags.csv", fiducial_table(tags).csv()},
      {"timing.csv", fiducial_table(timing).csv()},
      {"camera.svg", draw_fiducial_paths(paths)}};
  const std::vector<std::string> shown{"recording",
                                       "input",
                                       "camera_rms_m",
                                       "odometry_rms_m",
                                       "survey_frame_rms_m",
                                       "wrong_share",
                                       "wrong_frame_share",
                                       "detector_wrong_share",
                                       "several_sides_wrong_at_end",
                                       "wrong_at_end",
                                       "tags"};
  report.summary = fiducial_table(rows, shown).text(4);
  return report;
}

}  // namespace posemix
