// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "anees.hpp"
#include "figures.hpp"
#include "forecasts.hpp"
#include "paired.hpp"
#include "posemix/base/statistics.hpp"
#include "published.hpp"
#include "summary.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kInfinity = "inf";
constexpr std::size_t kMostRowsShown = 40;
constexpr std::size_t kCounts = 2;  ///< columns after the texts that are not averaged

Json to_json(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) {
    if (std::isinf(*number)) return kInfinity;
    return std::isnan(*number) ? Json() : Json(*number);
  }
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return *integer;
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return {};
}

Cell to_cell(const Json& json) {
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_string() && json == kInfinity) return std::numeric_limits<double>::infinity();
  if (json.is_string()) return json.get<std::string>();
  return {};
}

Json to_json(const std::vector<std::vector<Cell>>& rows) {
  Json json = Json::array();
  for (const auto& row : rows) {
    Json& cells = json.emplace_back(Json::array());
    for (const Cell& cell : row) cells.push_back(to_json(cell));
  }
  return json;
}

std::vector<std::vector<Cell>> to_rows(const Json& json) {
  std::vector<std::vector<Cell>> rows;
  for (const Json& cells : json) {
    auto& row = rows.emplace_back();
    for (const Json& cell : cells) row.push_back(to_cell(cell));
  }
  return rows;
}

/// The numbers of one column of some rows, without missing ones.
std::vector<double> numbers_of(const std::vector<const std::vector<Cell>*>& rows,
                               std::size_t column) {
  std::vector<double> numbers;
  for (const auto* row : rows) {
    if (const auto* number = std::get_if<double>(&(*row)[column])) numbers.push_back(*number);
  }
  return numbers;
}

/// Rows by detector and method, in the order of first appearance.
using Group = std::vector<const std::vector<Cell>*>;
std::vector<Group> groups_of(const StudyTable& table) {
  std::vector<Group> groups;
  for (const auto& row : table.rows()) {
    const auto same = [&](const Group& group) {
      return (*group[0])[2] == row[2] && (*group[0])[3] == row[3];
    };
    const auto found = std::find_if(groups.begin(), groups.end(), same);
    if (found == groups.end()) {
      groups.push_back({&row});
    } else {
      found->push_back(&row);
    }
  }
  return groups;
}

/// Mean and median rows of every detector and method.
StudyTable summarise(const StudyTable& table, std::size_t first_number) {
  StudyTable result(table.columns());
  const std::vector<Group> groups = groups_of(table);
  for (const bool median : {false, true}) {
    for (const Group& group : groups) {
      std::vector<Cell> row(table.columns().size());
      row[0] = median ? "median" : "mean";
      row[1] = "all";
      row[2] = (*group[0])[2];
      row[3] = (*group[0])[3];
      for (std::size_t column = first_number; column < row.size(); ++column) {
        const auto numbers = numbers_of(group, column);
        if (!numbers.empty()) row[column] = median ? posemix::median(numbers) : mean(numbers);
      }
      result.add(std::move(row));
    }
  }
  return result;
}

StudyTable joined(const StudyTable& first, const StudyTable& second) {
  StudyTable result = first;
  for (const auto& row : second.rows()) result.add(row);
  return result;
}

/// Rows of runs that are kept end with their pages.
std::vector<std::string> columns_of(const std::vector<YcbvRows>& items) {
  std::vector<std::string> columns = ycbv_columns();
  const bool has_pages = std::ranges::any_of(items, [&](const YcbvRows& rows) {
    return !rows.results.empty() && rows.results[0].size() > columns.size();
  });
  if (has_pages) columns.emplace_back("report");
  return columns;
}

/// The columns that fit on a screen.
std::string text_of(const StudyTable& table) {
  static const std::vector<std::pair<std::string, std::string>> shown{
      {"sequence", "sequence"},
      {"object", "object"},
      {"detector", "detector"},
      {"method", "method"},
      {"camera_rotation_rmse_deg", "cam deg"},
      {"camera_position_rmse_cm", "cam cm"},
      {"object_rotation_rmse_deg", "obj deg"},
      {"object_position_rmse_cm", "obj cm"},
      {"relative_rotation_rmse_deg", "rel deg"},
      {"relative_position_rmse_cm", "rel cm"},
      {"relative_anees", "ANEES"},
      {"right_mode_share", "right"},
      {"right_mode_anees", "ANEES right"},
      {"pixel_median", "px"},
      {"merges_per_frame", "merges"}};
  std::vector<std::string> names;
  std::vector<std::size_t> places;
  for (const auto& [column, name] : shown) {
    const auto& columns = table.columns();
    names.push_back(name);
    places.push_back(static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) -
                                              columns.begin()));
  }
  StudyTable result(names);
  for (const auto& row : table.rows()) {
    std::vector<Cell> cells(places.size());
    std::transform(places.begin(), places.end(), cells.begin(),
                   [&row](std::size_t place) { return row[place]; });
    result.add(std::move(cells));
  }
  return result.text(4);
}

/// The summary as text.
std::string text_of_summary(const StudyTable& summary) {
  StudyTable result({"detector", "method", "n", "px", "last map px", "> ACT", "last map > ACT",
                     "of", "cam deg/odom", "cam cm/odom", "recovered", "of wrong starts"});
  for (const auto& row : summary.rows()) result.add(row);
  return result.text(4);
}

constexpr std::string_view kYcbvQuestion =
    "How accurate and how consistent are the filters on recordings, beside the detector, the "
    "odometry and offline optimisation?";

/// For every detector the method of the least error in the image, and what to make of the tables.
std::vector<std::string> ycbv_notes(const StudyTable& summary) {
  std::map<std::string, std::pair<double, std::string>> least;
  bool published = false;
  for (const auto& row : summary.rows()) {
    const auto& method = std::get<std::string>(row[1]);
    published = published || is_published_offline(method);
    const auto* const pixels = std::get_if<double>(&row[3]);
    if (pixels == nullptr) continue;
    const std::pair found(*pixels, method);
    const auto [place, is_new] = least.try_emplace(std::get<std::string>(row[0]), found);
    if (!is_new) place->second = std::min(place->second, found);
  }
  std::vector<std::string> notes;
  notes.reserve(least.size() + 2);
  for (const auto& [detector, best] : least) {
    notes.push_back(fmt::format("{}: the least median error in the image has {}, {:.3g} px.",
                                detector, best.second, best.first));
  }
  notes.emplace_back(
      "ANEES is 1 when consistent; over recordings it is worth little as a median alone.");
  if (published) {
    notes.emplace_back(
        "published: ... are the published errors of offline optimisation, not run here; > ACT "
        "counts pairs with fewer px than published: ACT.");
  }
  return notes;
}

/// The consistency as text, with an explanation.
std::string text_of_anees(const StudyTable& anees) {
  if (anees.rows().empty()) return "";
  return "\nANEES over the recordings\n" + anees.text(3);
}

/// Estimates beside detections as text, with an explanation.
std::string text_of_paired(const StudyTable& paired) {
  if (paired.rows().empty()) return "";
  return "\nMedian errors of estimate and detection over the frames with both, by recording\n" +
         paired.text(3);
}

}  // namespace

const std::vector<std::string>& ycbv_columns() {
  static const std::vector<std::string> columns{"sequence",
                                                "object",
                                                "detector",
                                                "method",
                                                "frames",
                                                "detections",
                                                "camera_rotation_rmse_deg",
                                                "camera_position_rmse_cm",
                                                "camera_position_log_rmse_cm",
                                                "object_rotation_rmse_deg",
                                                "object_position_rmse_cm",
                                                "relative_rotation_rmse_deg",
                                                "relative_position_rmse_cm",
                                                "relative_anees",
                                                "pixel_median",
                                                "merges_per_frame",
                                                "pixel_median_last_map",
                                                "first_detection_wrong",
                                                "ends_on_right_mode",
                                                "right_mode_share",
                                                "right_mode_anees",
                                                "camera_anees",
                                                "camera_rotation_anees",
                                                "camera_position_anees",
                                                "world_anees",
                                                "paired_rotation_deg",
                                                "paired_position_cm",
                                                "paired_detection_rotation_deg",
                                                "paired_detection_position_cm",
                                                "object_truth"};
  return columns;
}

const std::vector<std::string>& ycbv_timing_columns() {
  static const std::vector<std::string> columns{
      "sequence",         "object",          "detector",      "method",          "frame_median_us",
      "update_median_us", "merge_median_us", "merge_mean_us", "merges_per_frame"};
  return columns;
}

std::string format_ycbv_rows(const YcbvRows& rows) {
  return Json{{"rows", to_json(rows.results)},
              {"timing", to_json(rows.timing)},
              {"forecasts", to_json(rows.forecasts)}}
      .dump();
}

YcbvRows parse_ycbv_rows(const std::string& text) {
  const Json json = Json::parse(text);
  return {to_rows(json.at("rows")), to_rows(json.at("timing")), to_rows(json.at("forecasts"))};
}

StudyReport report_ycbv(std::span<const std::string> items) {
  std::vector<YcbvRows> parsed;
  parsed.reserve(items.size());
  for (const std::string& item : items) parsed.push_back(parse_ycbv_rows(item));
  StudyTable results(columns_of(parsed));
  StudyTable timing(ycbv_timing_columns());
  std::vector<std::vector<Cell>> forecasts;
  for (YcbvRows& rows : parsed) {
    for (auto& row : rows.results) results.add(std::move(row));
    for (auto& row : rows.timing) timing.add(std::move(row));
    std::move(rows.forecasts.begin(), rows.forecasts.end(), std::back_inserter(forecasts));
  }
  const StudyTable means = summarise(results, kYcbvTexts + kCounts);
  const StudyTable all = joined(results, means);
  StudyReport report;
  const StudyTable summary = summarise_ycbv(results);
  const StudyTable anees = summarise_anees(results);
  const StudyTable paired = summarise_paired(results);
  report.notes = ycbv_notes(summary);
  report.files = {{"study.json", format_study({"ycbv", kYcbvQuestion, report.notes}, all, summary)},
                  {"ycbv.csv", all.csv()},
                  {"summary.csv", summary.csv()},
                  {"anees.csv", anees.csv()},
                  {"paired.csv", paired.csv()},
                  {"timing.csv", joined(timing, summarise(timing, kYcbvTexts)).csv()}};
  for (StudyFile& file : report_forecasts(forecasts)) report.files.push_back(std::move(file));
  for (StudyFile& figure : draw_ycbv(results)) report.files.push_back(std::move(figure));
  report.summary = text_of(results.rows().size() <= kMostRowsShown ? all : means) + "\n" +
                   text_of_summary(summary) + text_of_anees(anees) + text_of_paired(paired);
  return report;
}

}  // namespace posemix
