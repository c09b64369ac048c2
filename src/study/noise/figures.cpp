// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "draw/picture_colours.hpp"
#include "posemix/base/units.hpp"
#include "posemix/draw/chart.hpp"
#include "study/noise/json.hpp"
#include "study/noise/report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDensityPoints = 301;

/// Density of one coordinate of the residual at x, in the unit of the axis, without clutter. Along
/// the object's axes an offset counts by its logarithm; along others it has no place.
double marginal_density(const DetectorNoise& noise, std::size_t axis, double x) {
  const auto at = static_cast<Eigen::Index>(axis);
  const double unit = axis < 3 ? kRadPerDeg : 1.0;
  double sum = 0.0;
  for (const NoiseComponent& component : noise.components()) {
    const Vector6d offset = component.offset.log();
    if (component.frame != NoiseFrame::object && offset.norm() > 0.0) continue;
    const double sd = std::sqrt(component.covariance(at, at)) / unit;
    const double z = (x - offset[at] / unit) / sd;
    sum += component.weight * std::exp(-0.5 * z * z) / (sd * std::sqrt(2.0 * std::numbers::pi));
  }
  return sum;
}

ChartSeries curve(const std::string& label, const DetectorNoise& noise, std::size_t axis,
                  double reach, double unit) {
  ChartSeries series{.label = label};
  for (int i = 0; i < kDensityPoints; ++i) {
    const double x = reach * (2.0 * i / (kDensityPoints - 1) - 1.0);
    series.x.push_back(unit * x);
    series.y.push_back(marginal_density(noise, axis, x) / unit);
  }
  return series;
}

Chart axis_chart(const Json& item, std::size_t axis) {
  const Json& histogram = item["axes"][axis]["histogram"];
  const double unit = axis < 3 ? 1.0 : along_ray(item) ? 100.0 : 1e3;  // per cent of the range
  const std::string name = axis < 3 ? "deg" : along_ray(item) ? "% of range" : "mm";
  const double reach = histogram["reach"];
  const auto counts = histogram["counts"].get<std::vector<double>>();
  const double width = 2.0 * reach / static_cast<double>(counts.size());
  const double total = item["axes"][axis]["count"];
  Chart chart{.title = std::string(kNoiseAxes[axis]),
              .x_label = fmt::format("residual [{}]", name),
              .y_label = fmt::format("density [1/{}]", axis < 3 || !along_ray(item) ? name : "%"),
              .log_y = true};
  ChartSeries bars{
      .label = "detections", .color = std::string(internal::kTruthColour), .step = true};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    bars.x.push_back(unit * (static_cast<double>(i) * width - reach));
    bars.y.push_back(counts[i] / (total * width * unit));
  }
  bars.x.push_back(unit * reach);
  // Half of one detection is the least that is shown, so that the tails are seen to their ends.
  const double highest = *std::max_element(bars.y.begin(), bars.y.end());
  chart.y_range = std::pair(0.5 / (total * width * unit), 3.0 * highest);
  chart.series.push_back(std::move(bars));
  const DetectorNoise single = noise_from_json(item["models"][0]["noise"]);
  chart.series.push_back(curve("one component", single, axis, reach, unit));
  const Json& model = chosen_model(item);
  if (model["components"] > 1) {
    chart.series.push_back(curve(fmt::format("{} components", model["components"].get<int>()),
                                 noise_from_json(model["noise"]), axis, reach, unit));
  }
  return chart;
}

}  // namespace

bool along_ray(const Json& item) { return item["frame"] == "ray"; }

const Json& chosen_model(const Json& item) {
  for (const Json& model : item["models"]) {
    if (model["chosen"].get<bool>()) return model;
  }
  return item["models"].back();
}

std::string draw_residuals(const Json& item) {
  std::vector<Chart> charts;
  charts.reserve(6);
  for (std::size_t axis = 0; axis < 6; ++axis) charts.push_back(axis_chart(item, axis));
  const std::string title = fmt::format(
      "Residuals of {} for {}{}", item["detector"].get<std::string>(),
      item["object"].get<std::string>(), item["proxy"].get<bool>() ? " (against a proxy)" : "");
  return draw_charts(title, charts, 3);
}

}  // namespace posemix
