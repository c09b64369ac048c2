// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "noise_parts.hpp"
#include "posemix/base/units.hpp"
#include "posemix/io/chart.hpp"
#include "posemix/study/table.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kCurvePoints = 301;

constexpr std::array kAxisColumns{"count",
                                  "mean",
                                  "sd",
                                  "rms",
                                  "median",
                                  "robust_sd",
                                  "skewness",
                                  "kurtosis",
                                  "lag1_autocorrelation",
                                  "correlation_frames",
                                  "effective_count",
                                  "inlier_sd",
                                  "inlier_lag1_autocorrelation",
                                  "inlier_correlation_frames",
                                  "inlier_sd_of_recordings"};

Cell cell(const Json& json) {
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  return {};
}

std::string truth_of(const Json& item) { return item["proxy"].get<bool>() ? "proxy" : "annotated"; }

StudyTable axis_table(const std::vector<Json>& items) {
  std::vector<std::string> columns{"detector", "object", "truth", "recordings", "axis", "unit"};
  columns.insert(columns.end(), kAxisColumns.begin(), kAxisColumns.end());
  columns.emplace_back("gross_errors");
  StudyTable table(columns);
  for (const Json& item : items) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      std::vector<Cell> row{cell(item["detector"]),   cell(item["object"]), truth_of(item),
                            cell(item["recordings"]), kNoiseAxes[axis],     axis < 3 ? "deg" : "m"};
      for (const char* column : kAxisColumns) row.push_back(cell(item["axes"][axis][column]));
      row.push_back(cell(item["gross_errors"]));
      table.add(std::move(row));
    }
  }
  return table;
}

StudyTable model_table(const std::vector<Json>& items) {
  StudyTable table({"detector", "object", "components", "parameters", "log_likelihood", "bic",
                    "bic_effective", "iterations", "status", "chosen"});
  for (const Json& item : items) {
    for (const Json& model : item["models"]) {
      table.add({cell(item["detector"]), cell(item["object"]), cell(model["components"]),
                 cell(model["parameters"]), cell(model["log_likelihood"]), cell(model["bic"]),
                 cell(model["bic_effective"]), cell(model["iterations"]), cell(model["status"]),
                 std::int64_t{model["chosen"].get<bool>() ? 1 : 0}});
    }
  }
  return table;
}

const Json& chosen_model(const Json& item) {
  for (const Json& model : item["models"]) {
    if (model["chosen"].get<bool>()) return model;
  }
  return item["models"].back();
}

/// Density of one coordinate of the residual at x, in the unit of the axis. An offset counts by its
/// logarithm.
double marginal_density(const DetectorNoise& noise, std::size_t axis, double x) {
  const auto at = static_cast<Eigen::Index>(axis);
  const double unit = axis < 3 ? kRadPerDeg : 1.0;
  double sum = 0.0;
  for (const NoiseComponent& component : noise.components()) {
    const double sd = std::sqrt(component.covariance(at, at)) / unit;
    const double z = (x - component.offset.log()[at] / unit) / sd;
    sum += component.weight * std::exp(-0.5 * z * z) / (sd * std::sqrt(2.0 * std::numbers::pi));
  }
  return sum;
}

ChartSeries curve(const std::string& label, const DetectorNoise& noise, std::size_t axis,
                  double reach, double unit) {
  ChartSeries series{.label = label};
  for (int i = 0; i < kCurvePoints; ++i) {
    const double x = reach * (2.0 * i / (kCurvePoints - 1) - 1.0);
    series.x.push_back(unit * x);
    series.y.push_back(marginal_density(noise, axis, x) / unit);
  }
  return series;
}

Chart axis_chart(const Json& item, std::size_t axis) {
  const Json& histogram = item["axes"][axis]["histogram"];
  const double unit = axis < 3 ? 1.0 : 100.0;  // drawn in deg and cm
  const double reach = histogram["reach"];
  const auto counts = histogram["counts"].get<std::vector<double>>();
  const double width = 2.0 * reach / static_cast<double>(counts.size());
  const double total = item["axes"][axis]["count"];
  Chart chart{.title = std::string(kNoiseAxes[axis]),
              .x_label = axis < 3 ? "residual [deg]" : "residual [cm]",
              .y_label = axis < 3 ? "density [1/deg]" : "density [1/cm]"};
  ChartSeries bars{.label = "detections", .color = "#888888", .step = true};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    bars.x.push_back(unit * (static_cast<double>(i) * width - reach));
    bars.y.push_back(counts[i] / (total * width * unit));
  }
  bars.x.push_back(unit * reach);
  chart.series.push_back(std::move(bars));
  const DetectorNoise single = noise_from_json(item["models"][0]["noise"]);
  chart.series.push_back(curve("one Gaussian", single, axis, reach, unit));
  const Json& model = chosen_model(item);
  if (model["components"] > 1) {
    chart.series.push_back(curve(fmt::format("{} components", model["components"].get<int>()),
                                 noise_from_json(model["noise"]), axis, reach, unit));
  }
  return chart;
}

std::string toml_of(const Json& item, const std::string& name) {
  const Json& model = chosen_model(item);
  std::string text = fmt::format(
      "# Fitted to {} detections of {} by {} in {} recordings: {} components by the BIC, among "
      "{}.\n",
      item["axes"][0]["count"].get<std::int64_t>(), item["object"].get<std::string>(),
      item["detector"].get<std::string>(), item["recordings"].get<std::int64_t>(),
      model["components"].get<std::int64_t>(), item["models"].size());
  if (item["proxy"].get<bool>()) {
    text +=
        "# The truth was a proxy, the mean of the detections: what they share is not in here.\n";
  }
  return text + format_noise_toml(name, noise_from_json(model["noise"]));
}

std::string summary_of(const std::vector<Json>& items) {
  StudyTable table({"detector", "object", "truth", "axis", "count", "mean", "sd", "robust_sd",
                    "kurtosis", "lag1", "corr_frames", "gross", "K"});
  for (const Json& item : items) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const Json& a = item["axes"][axis];
      table.add({cell(item["detector"]), cell(item["object"]), truth_of(item), kNoiseAxes[axis],
                 cell(a["count"]), cell(a["mean"]), cell(a["sd"]), cell(a["robust_sd"]),
                 cell(a["kurtosis"]), cell(a["lag1_autocorrelation"]),
                 cell(a["correlation_frames"]), cell(item["gross_errors"]),
                 cell(chosen_model(item)["components"])});
    }
  }
  return "Rotations in deg, translations in m. Truth `proxy`: the mean of the detections "
         "themselves.\n" +
         table.text(3);
}

}  // namespace

StudyReport report_noise(std::span<const std::string> results) {
  std::vector<Json> items;
  for (const std::string& result : results) items.push_back(Json::parse(result));
  const StudyTable axes = axis_table(items);
  StudyReport report;
  report.files.push_back({"study.json", format_study("noise", axes)});
  report.files.push_back({"noise.csv", axes.csv()});
  report.files.push_back({"models.csv", model_table(items).csv()});
  for (const Json& item : items) {
    const std::string name = noise_name(item["detector"], item["object"]);
    std::vector<Chart> charts;
    for (std::size_t axis = 0; axis < 6; ++axis) charts.push_back(axis_chart(item, axis));
    const std::string title = fmt::format(
        "Residuals of {} for {}{}", item["detector"].get<std::string>(),
        item["object"].get<std::string>(), item["proxy"].get<bool>() ? " (against a proxy)" : "");
    report.files.push_back({"noise_" + name + ".toml", toml_of(item, name)});
    report.files.push_back({"noise_" + name + ".svg", draw_charts(title, charts, 3)});
  }
  report.summary = summary_of(items);
  return report;
}

}  // namespace posemix
