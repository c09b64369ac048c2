// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "draw/picture_colours.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/draw/chart.hpp"
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

using Words = std::vector<std::pair<std::string_view, std::string_view>>;

/// The name of a summary figure in words, with its unit: "paired_rotation_deg" is "estimate, views
/// with both: median rotation error" [deg].
std::string words_of_figure(std::string_view name) {
  static const Words parts{{"paired_detection_", "detection, views with both: "},
                           {"paired_", "estimate, views with both: "},
                           {"detection_", "detection: "},
                           {"end_", "estimate at the end: "}};
  static const Words words{
      {"found_share", "share found"},
      {"within_share", "share within 20 deg and 5 cm"},
      {"rotation_deg", "median rotation error"},
      {"translation_m", "median position error"},
      {"mssd_m", "median MSSD"},
      {"views_of_instances", "views of instances"},
      {"false_confirmed", "confirmed objects that are none"},
      {"confirmed", "confirmed objects"},
      {"recycled", "tracks given to another instance"},
      {"flip_share", "share of steps with a flip"},
      {"axis_turn_share", "share of steps with a turned axis"},
      {"camera_rotation_rmse_deg", "camera: rotation error (rms)"},
      {"camera_position_rmse_m", "camera: position error (rms)"},
      {"synthetic_odometry_rotation_rmse_deg", "odometry: rotation error (rms)"},
      {"synthetic_odometry_position_rmse_m", "odometry: position error (rms)"}};
  std::string text;
  for (const auto& [prefix, meaning] : parts) {
    if (!name.starts_with(prefix)) continue;
    name.remove_prefix(prefix.size());
    text = meaning;
    break;
  }
  const auto known = std::find_if(words.begin(), words.end(),
                                  [&](const auto& word) { return word.first == name; });
  if (known == words.end()) return text + std::string(name);
  // Of the estimates of all views.
  const bool is_estimate = text.empty() && known - words.begin() < 5;
  return (is_estimate ? "estimate: " : text) + std::string(known->second);
}

/// The summary in words, lengths in mm.
StudyTable readable(const StudyTable& summary) {
  StudyTable table({"figure", "unit", "declared", "none"});
  for (const std::vector<Cell>& row : summary.rows()) {
    const auto& name = std::get<std::string>(row[0]);
    const bool is_length = name.ends_with("_m");
    const auto shown = [&](const Cell& cell) {
      const auto* const number = std::get_if<double>(&cell);
      return number != nullptr && is_length ? Cell(1e3 * *number) : cell;
    };
    const char* const unit = is_length ? "mm" : name.ends_with("_deg") ? "deg" : "";
    table.add({words_of_figure(name), unit, shown(row[1]), shown(row[2])});
  }
  return table;
}

constexpr std::string_view kTlessQuestion =
    "How well are several equal objects told apart and located, when their symmetries are declared "
    "and when they are not?";

std::vector<std::string> tless_notes(const Figures& declared, const Figures& none) {
  const auto value = [](const Figures& figures, std::string_view name) {
    const auto found = std::find_if(figures.begin(), figures.end(),
                                    [&](const auto& figure) { return figure.first == name; });
    const auto* const number =
        found == figures.end() ? nullptr : std::get_if<double>(&found->second);
    return number == nullptr ? std::string("-") : fmt::format("{:.3g} %", 100.0 * *number);
  };
  return {fmt::format(
              "Within 20 deg and 5 cm are {} of the views of instances with declared symmetries, "
              "{} without, and {} of the detections alone.",
              value(declared, "within_share"), value(none, "within_share"),
              value(declared, "detection_within_share")),
          fmt::format("The orientation flips in {} of the steps with declared symmetries, in {} "
                      "without.",
                      value(declared, "flip_share"), value(none, "flip_share"))};
}

/// The median errors of the instances, sorted, over the share of the instances.
ChartSeries sorted_instances(const std::vector<Json>& instances, const std::string& key,
                             double unit, const std::string& label, std::string colour) {
  ChartSeries series{.label = label, .y = known(instances, key), .color = std::move(colour)};
  std::sort(series.y.begin(), series.y.end());
  const auto count = static_cast<double>(series.y.size());
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    series.x.push_back((static_cast<double>(i) + 0.5) / count);
    series.y[i] *= unit;
  }
  return series;
}

std::string tless_figure(const std::vector<Json>& declared, const std::vector<Json>& none) {
  std::vector<Chart> charts;
  for (const auto& [key, unit, title, label] :
       {std::tuple("rotation_deg", 1.0, "Rotation", "median error [deg]"),
        std::tuple("mssd_m", 1e3, "Largest distance of surfaces (MSSD)", "median [mm]")}) {
    Chart& chart = charts.emplace_back(Chart{.title = title,
                                             .x_label = "share of the instances",
                                             .y_label = label,
                                             .log_y = true,
                                             .x_range = std::pair(0.0, 1.0)});
    const std::string paired = std::string("paired_") + key;
    const std::string detected = std::string("paired_detection_") + key;
    chart.series = {
        sorted_instances(declared, paired, unit, "estimate, symmetries declared",
                         internal::object_colour(2)),
        sorted_instances(none, paired, unit, "estimate, none declared", internal::object_colour(1)),
        sorted_instances(declared, detected, unit, "detection",
                         std::string(internal::kTruthColour))};
  }
  return draw_charts(
      "Errors of each instance over the views with estimate and detection", charts, 2,
      "A line through 0.8 and 10 says: for 80 % of the instances the median error is "
      "at most 10.");
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
  const std::vector<Json> with = with_symmetries(instances, "declared");
  const std::vector<Json> without = with_symmetries(instances, "none");
  const Figures declared = figures_of(with, with_symmetries(scenes, "declared"));
  const Figures none = figures_of(without, with_symmetries(scenes, "none"));
  StudyTable summary({"figure", "declared", "none"});
  for (std::size_t i = 0; i < declared.size(); ++i)
    summary.add({declared[i].first, declared[i].second, none[i].second});

  const StudyTable rows = tless_table(instances);
  const StudyTable words = readable(summary);
  StudyReport report;
  report.notes = tless_notes(declared, none);
  report.files = {
      {"study.json", format_study({"tless", kTlessQuestion, report.notes}, rows, words)},
      {"tless.csv", rows.csv()},
      {"scenes.csv", tless_table(scenes).csv()},
      {"summary.csv", summary.csv()},
      {"errors.svg", tless_figure(with, without)}};
  report.summary = words.text(4);
  return report;
}

}  // namespace posemix
