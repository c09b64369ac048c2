// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "posemix/io/chart.hpp"
#include "ycbv_parts.hpp"

namespace posemix {
namespace {

constexpr const char* kGrey = "#8A8A8A";

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// An empty series of a method. Known methods keep their colours from figure to figure; that of
/// the midway merge is dashed, so that the rule which it often equals shows below it.
ChartSeries series_of(const std::string& method) {
  static const std::map<std::string, const char*> colours{{"detector", kGrey},
                                                          {"odometry", kGrey},
                                                          {"riekf", "#D55E00"},
                                                          {"riekf_gated", "#E69F00"},
                                                          {"tangent_of_larger", "#CC79A7"},
                                                          {"midway", "#009E73"},
                                                          {"midway_iterated", "#56B4E9"},
                                                          {"published", "#222222"},
                                                          {"default", "#0072B2"}};
  const auto found = colours.find(method);
  return {.label = method,
          .color = found == colours.end() ? "" : found->second,
          .dash = method == "midway" ? "5 3" : "",
          .markers = true};
}

/// A study's table, read by names.
class Rows {
 public:
  explicit Rows(const StudyTable& table) : table_(table) {}

  std::size_t size() const { return table_.rows().size(); }
  std::string text(std::size_t row, std::string_view column) const {
    const auto* text = std::get_if<std::string>(&cell(row, column));
    return text != nullptr ? *text : std::string();
  }
  /// NaN where there is nothing.
  double number(std::size_t row, std::string_view column) const {
    const auto* number = std::get_if<double>(&cell(row, column));
    return number != nullptr ? *number : kNothing;
  }
  /// The different texts of a column, in the order of their first.
  std::vector<std::string> names(std::string_view column) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < size(); ++i) {
      const std::string name = text(i, column);
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names;
  }

 private:
  const Cell& cell(std::size_t row, std::string_view column) const {
    const auto& columns = table_.columns();
    const auto found = std::find(columns.begin(), columns.end(), column);
    return table_.rows()[row][static_cast<std::size_t>(found - columns.begin())];
  }

  const StudyTable& table_;
};

/// The errors of one method, sorted, over the share of the recordings.
ChartSeries sorted_errors(const Rows& rows, const std::string& detector, const std::string& method,
                          std::string_view column) {
  ChartSeries series = series_of(method);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool fits = rows.text(i, "detector") == detector && rows.text(i, "method") == method;
    if (fits && !std::isnan(rows.number(i, column))) series.y.push_back(rows.number(i, column));
  }
  std::sort(series.y.begin(), series.y.end());
  const auto count = static_cast<double>(series.y.size());
  for (std::size_t i = 0; i < series.y.size(); ++i)
    series.x.push_back((static_cast<double>(i) + 0.5) / count);
  return series;
}

Chart error_chart(const Rows& rows, const std::string& detector, std::string_view column,
                  const std::string& label) {
  Chart chart{.title = detector,
              .x_label = "share of recordings and objects",
              .y_label = label,
              .log_y = true,
              .x_range = std::pair(0.0, 1.0)};
  for (const std::string& method : rows.names("method")) {
    ChartSeries series = sorted_errors(rows, detector, method, column);
    if (!series.y.empty()) chart.series.push_back(std::move(series));
  }
  return chart;
}

std::string draw_errors(const Rows& rows) {
  std::vector<Chart> charts;
  for (const std::string& detector : rows.names("detector")) {
    for (const auto& [column, label] :
         {std::pair("pixel_median", "median error in the image [px]"),
          std::pair("relative_rotation_rmse_deg", "relative rotation, rms [deg]")}) {
      Chart chart = error_chart(rows, detector, column, label);
      if (!chart.series.empty()) charts.push_back(std::move(chart));
    }
  }
  if (charts.empty()) charts.push_back({.title = "no ground truth"});
  return draw_charts("Object relative to the camera: errors of each method, sorted", charts,
                     charts.size() == 1 ? 1 : 2);
}

/// Error of the odometry alone by detector, sequence and object.
using Reference = std::map<std::string, double>;

std::string key_of(const Rows& rows, std::size_t i) {
  return fmt::format("{}/{}/{}", rows.text(i, "detector"), rows.text(i, "sequence"),
                     rows.text(i, "object"));
}

Reference odometry_errors(const Rows& rows, std::string_view column) {
  Reference reference;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.text(i, "method") == "odometry") reference[key_of(rows, i)] = rows.number(i, column);
  }
  return reference;
}

/// Single points: one method's error over that of the odometry.
ChartSeries against_odometry(const Rows& rows, const Reference& odometry, const std::string& method,
                             std::string_view column) {
  ChartSeries series = series_of(method);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto found = odometry.find(key_of(rows, i));
    if (rows.text(i, "method") != method || found == odometry.end()) continue;
    series.x.insert(series.x.end(), {found->second, kNothing});
    series.y.insert(series.y.end(), {rows.number(i, column), kNothing});
  }
  return series;
}

Chart camera_chart(const Rows& rows, std::string_view column, const std::string& title,
                   const std::string& unit) {
  Chart chart{.title = title,
              .x_label = fmt::format("odometry alone, rms [{}]", unit),
              .y_label = fmt::format("filter, rms [{}]", unit),
              .log_x = true,
              .log_y = true};
  const Reference odometry = odometry_errors(rows, column);
  ChartSeries same{.label = "as the odometry", .color = kGrey, .dash = "5 4"};
  for (const auto& [key, error] : odometry) {
    if (!std::isnan(error)) same.x.push_back(error);
  }
  std::sort(same.x.begin(), same.x.end());
  same.y = same.x;
  chart.series.push_back(std::move(same));
  for (const std::string& method : rows.names("method")) {
    if (method != "odometry" && method != "detector")
      chart.series.push_back(against_odometry(rows, odometry, method, column));
  }
  return chart;
}

std::string draw_camera(const Rows& rows) {
  const std::vector<Chart> charts{camera_chart(rows, "camera_rotation_rmse_deg", "rotation", "deg"),
                                  camera_chart(rows, "camera_position_rmse_cm", "position", "cm")};
  return draw_charts("Camera: error of each filter against its odometry alone", charts, 2);
}

}  // namespace

std::vector<StudyFile> draw_ycbv(const StudyTable& rows) {
  return {{"errors.svg", draw_errors(Rows(rows))}, {"camera.svg", draw_camera(Rows(rows))}};
}

}  // namespace posemix
