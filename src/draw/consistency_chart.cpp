// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/draw/consistency_chart.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "picture_colours.hpp"
#include "posemix/base/error.hpp"
#include "posemix/draw/chart.hpp"

namespace posemix {
namespace {

constexpr std::size_t kMostPoints = 1000;
constexpr double kLowestShown = 1e-3;
constexpr std::string_view kLineColour = internal::kObjectColours[2];
constexpr std::string_view kBandColour = internal::kTruthColour;
constexpr std::string_view kMeanColour = internal::kObjectColours[1];

using NeesOf = double FrameConsistency::*;

/// NEES over the degrees of freedom, averaged over as many frames as leave kMostPoints.
ChartSeries nees_series(const ConsistencyReport& report, NeesOf nees_of, std::size_t dof) {
  ChartSeries series{.label = "NEES per degree of freedom", .color = std::string(kLineColour)};
  const std::size_t stride = (report.frames.size() + kMostPoints - 1) / kMostPoints;
  for (std::size_t k = 0; k < report.frames.size(); k += stride) {
    const std::size_t end = std::min(k + stride, report.frames.size());
    double sum = 0.0;
    for (std::size_t i = k; i < end; ++i) sum += report.frames[i].*nees_of;
    const double mean = sum / static_cast<double>((end - k) * dof);
    series.x.push_back(report.frames[k].stamp_s);
    series.y.push_back(std::max(mean, kLowestShown));
  }
  return series;
}

Chart nees_chart(const std::string& title, const ConsistencyReport& report,
                 const NeesSummary& summary, NeesOf nees_of) {
  const double first = report.frames.front().stamp_s;
  const double last = report.frames.back().stamp_s;
  ChartSeries nees = nees_series(report, nees_of, summary.dof);
  const auto [least, most] = std::minmax_element(nees.y.begin(), nees.y.end());
  const double low = std::min({*least, summary.anees, summary.frame_band.low});
  const double high = std::max({*most, summary.anees, summary.frame_band.high});
  const auto level = [&](const char* label, double value, std::string_view colour,
                         const char* dash) {
    return ChartSeries{.label = label,
                       .x = {first, last},
                       .y = {value, value},
                       .color = std::string(colour),
                       .dash = dash};
  };
  ChartSeries band = level("95 % of the frames of a consistent estimate", 1.0, kBandColour, "6 4");
  band.lower.assign(2, summary.frame_band.low);
  band.upper.assign(2, summary.frame_band.high);
  return {.title = fmt::format("{}: ANEES {:.3g}, 95 % interval {:.3g} to {:.3g}", title,
                               summary.anees, summary.interval.low, summary.interval.high),
          .x_label = "time [s]",
          .y_label = fmt::format("NEES / {}", summary.dof),
          .log_y = true,
          .series = {std::move(band), std::move(nees),
                     level("ANEES", std::max(summary.anees, kLowestShown), kMeanColour, "")},
          .y_range = std::pair(std::max(low, kLowestShown) / 1.3, 1.3 * high)};
}

}  // namespace

std::string draw_consistency(std::string_view title, std::span<const NamedConsistency> poses) {
  require(!poses.empty(), "consistency: got no pose to draw, expected at least one");
  std::vector<Chart> charts;
  for (const auto& [name, report] : poses) {
    if (report.frames.empty())
      throw InvalidInput(fmt::format("consistency: pose '{}' has no frame to draw", name));
    charts.push_back(
        nees_chart(poses.size() > 1 ? name : "pose", report, report.pose, &FrameConsistency::nees));
    if (poses.size() > 1) continue;
    if (report.rotation) {
      charts.push_back(
          nees_chart("rotation", report, *report.rotation, &FrameConsistency::rotation_nees));
    }
    charts.push_back(
        nees_chart("position", report, report.position, &FrameConsistency::position_nees));
  }
  const std::string whole =
      poses.size() > 1 ? std::string(title) : fmt::format("{}: {}", title, poses.front().name);
  return draw_charts(whole, charts, 1);
}

}  // namespace posemix
