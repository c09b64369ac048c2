// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "draw/method_colours.hpp"
#include "draw/picture_colours.hpp"
#include "posemix/draw/chart.hpp"
#include "published.hpp"
#include "table_reader.hpp"

namespace posemix {
namespace {

constexpr std::string_view kGrey = internal::kTruthColour;

/// The offline method that the figures show.
constexpr const char* kAct = "published: ACT";

/// The errors of one method, sorted, over the share of the recordings.
ChartSeries sorted_errors(const TableReader& rows, const std::string& detector,
                          const std::string& method, std::string_view column) {
  ChartSeries series = internal::method_series(method);
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

Chart error_chart(const TableReader& rows, const std::string& detector, std::string_view column,
                  const std::string& title, const std::string& label) {
  Chart chart{.title = fmt::format("{}: {}", detector, title),
              .x_label = "share of recordings and objects",
              .y_label = label,
              .log_y = true,
              .x_range = std::pair(0.0, 1.0)};
  for (const std::string& method : rows.names("method")) {
    if (is_published_offline(method) && method != kAct) continue;
    ChartSeries series = sorted_errors(rows, detector, method, column);
    if (!series.y.empty()) chart.series.push_back(std::move(series));
  }
  return chart;
}

std::string draw_errors(const TableReader& rows) {
  std::vector<Chart> charts;
  for (const std::string& detector : rows.names("detector")) {
    for (const auto& [column, title, label] :
         {std::tuple("pixel_median", "error in the image", "median over the frames [px]"),
          std::tuple("relative_rotation_rmse_deg", "rotation", "rms over the frames [deg]")}) {
      Chart chart = error_chart(rows, detector, column, title, label);
      if (!chart.series.empty()) charts.push_back(std::move(chart));
    }
  }
  if (charts.empty()) charts.push_back({.title = "no ground truth"});
  return draw_charts("Object relative to the camera: errors of each method, sorted", charts,
                     charts.size() == 1 ? 1 : 2,
                     "A line through 0.8 and 10 says: in 80 % of the recordings of an object the "
                     "error is at most 10.");
}

/// Errors of the odometry alone by detector, sequence and object.
using Reference = std::map<std::string, double>;

Reference odometry_errors(const TableReader& rows, std::string_view column) {
  Reference reference;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.text(i, "method") == "odometry") reference[rows.key(i)] = rows.number(i, column);
  }
  return reference;
}

/// Single points: the errors of one method (y) and of the odometry (x).
ChartSeries against_odometry(const TableReader& rows, const Reference& odometry,
                             const std::string& method, std::string_view column) {
  ChartSeries series = internal::method_series(method);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto found = odometry.find(rows.key(i));
    if (rows.text(i, "method") != method || found == odometry.end()) continue;
    series.x.insert(series.x.end(), {found->second, TableReader::kNothing});
    series.y.insert(series.y.end(), {rows.number(i, column), TableReader::kNothing});
  }
  return series;
}

Chart camera_chart(const TableReader& rows, std::string_view column, const std::string& title,
                   const std::string& unit) {
  Chart chart{.title = title,
              .x_label = fmt::format("odometry alone, rms [{}]", unit),
              .y_label = fmt::format("filter, rms [{}]", unit),
              .log_x = true,
              .log_y = true};
  const Reference odometry = odometry_errors(rows, column);
  ChartSeries same{.label = "as the odometry", .color = std::string(kGrey), .dash = "5 4"};
  for (const auto& [key, error] : odometry) {
    if (!std::isnan(error)) same.x.push_back(error);
  }
  std::sort(same.x.begin(), same.x.end());
  same.y = same.x;
  chart.series.push_back(std::move(same));
  for (const std::string& method : rows.names("method")) {
    if (method != "odometry" && method != "detector" && !is_published_offline(method))
      chart.series.push_back(against_odometry(rows, odometry, method, column));
  }
  return chart;
}

std::string draw_camera(const TableReader& rows) {
  const std::vector<Chart> charts{camera_chart(rows, "camera_rotation_rmse_deg", "rotation", "deg"),
                                  camera_chart(rows, "camera_position_rmse_cm", "position", "cm")};
  return draw_charts("Camera: error of each filter against its odometry alone", charts, 2);
}

}  // namespace

std::vector<StudyFile> draw_ycbv(const StudyTable& rows) {
  return {{"errors.svg", draw_errors(TableReader(rows))},
          {"camera.svg", draw_camera(TableReader(rows))}};
}

}  // namespace posemix
