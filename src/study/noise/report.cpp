// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/report.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/noise_toml.hpp"
#include "posemix/draw/chart.hpp"
#include "study/engine/table.hpp"
#include "study/noise/groups.hpp"
#include "study/noise/json.hpp"
#include "study/noise/odometry_report.hpp"
#include "study/noise/slow_report.hpp"

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

constexpr std::array kCorrelationColumns{"dependent_frames", "dependent_frames_within", "bias_sd"};

constexpr std::array kGroupCorrelationColumns{
    "inliers",     "dependent_frames",         "dependent_frames_within",        "outlier_share",
    "outlier_run", "outlier_dependent_frames", "outlier_dependent_frames_within"};

Cell cell(const Json& json) {
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  if (json.is_boolean()) return std::int64_t{json.get<bool>() ? 1 : 0};
  if (json.is_string()) return json.get<std::string>();
  return {};
}

std::string truth_of(const Json& item) { return item["proxy"].get<bool>() ? "proxy" : "annotated"; }

bool along_ray(const Json& item) { return item["frame"] == "ray"; }

std::string unit_of(const Json& item, std::size_t axis) {
  if (axis < 3) return "deg";
  return along_ray(item) ? "range" : "m";
}

void add_columns(const Json& json, std::span<const char* const> columns, std::vector<Cell>& row) {
  for (const char* column : columns) row.push_back(cell(json[column]));
}

StudyTable axis_table(const std::vector<Json>& items) {
  std::vector<std::string> columns{"detector",   "object", "truth", "symmetric",
                                   "recordings", "axis",   "unit"};
  columns.insert(columns.end(), kAxisColumns.begin(), kAxisColumns.end());
  columns.emplace_back("gross_errors");
  columns.insert(columns.end(), kCorrelationColumns.begin(), kCorrelationColumns.end());
  StudyTable table(columns);
  for (const Json& item : items) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      std::vector<Cell> row{
          cell(item["detector"]),   cell(item["object"]),
          truth_of(item),           std::int64_t{item["symmetric"].get<bool>() ? 1 : 0},
          cell(item["recordings"]), kNoiseAxes[axis],
          unit_of(item, axis)};
      add_columns(item["axes"][axis], kAxisColumns, row);
      row.push_back(cell(item["gross_errors"]));
      add_columns(item["correlation"]["axes"][axis], kCorrelationColumns, row);
      table.add(std::move(row));
    }
  }
  return table;
}

/// One row per group, or per entry of an array of the group.
StudyTable group_table(const std::vector<Json>& items, const char* key,
                       std::span<const char* const> columns) {
  std::vector<std::string> names{"detector", "object"};
  names.insert(names.end(), columns.begin(), columns.end());
  StudyTable table(names);
  for (const Json& item : items) {
    if (!item.contains(key)) continue;
    const Json rows = item[key].is_array() ? item[key] : Json::array({item[key]});
    for (const Json& entry : rows) {
      std::vector<Cell> row{cell(item["detector"]), cell(item["object"])};
      add_columns(entry, columns, row);
      table.add(std::move(row));
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
  for (int i = 0; i < kCurvePoints; ++i) {
    const double x = reach * (2.0 * i / (kCurvePoints - 1) - 1.0);
    series.x.push_back(unit * x);
    series.y.push_back(marginal_density(noise, axis, x) / unit);
  }
  return series;
}

Chart axis_chart(const Json& item, std::size_t axis) {
  const Json& histogram = item["axes"][axis]["histogram"];
  const double unit = axis < 3 ? 1.0 : 100.0;  // drawn in deg and cm, or per cent of the range
  const std::string name = axis < 3 ? "deg" : along_ray(item) ? "% of range" : "cm";
  const double reach = histogram["reach"];
  const auto counts = histogram["counts"].get<std::vector<double>>();
  const double width = 2.0 * reach / static_cast<double>(counts.size());
  const double total = item["axes"][axis]["count"];
  Chart chart{.title = std::string(kNoiseAxes[axis]),
              .x_label = fmt::format("residual [{}]", name),
              .y_label = fmt::format("density [1/{}]", axis < 3 || !along_ray(item) ? name : "%")};
  ChartSeries bars{.label = "detections", .color = "#888888", .step = true};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    bars.x.push_back(unit * (static_cast<double>(i) * width - reach));
    bars.y.push_back(counts[i] / (total * width * unit));
  }
  bars.x.push_back(unit * reach);
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
  return text + slow_error_comment(item) +
         format_noise_toml(name, dependent_noise_from_json(item["noise"]));
}

/// The chosen models and the correlation of their errors, one row per group.
StudyTable summary_table(const std::vector<Json>& items) {
  StudyTable table({"detector", "object", "truth", "symm", "count", "gross", "K", "clutter",
                    "modes", "lag1", "dep frames", "within", "out run", "dep out"});
  for (const Json& item : items) {
    const Json& model = chosen_model(item);
    const Json& correlation = item["correlation"];
    std::vector<double> lags;
    for (const Json& axis : item["axes"]) {
      if (axis["inlier_lag1_autocorrelation"].is_number())
        lags.push_back(axis["inlier_lag1_autocorrelation"]);
    }
    table.add({cell(item["detector"]), cell(item["object"]), truth_of(item),
               item["symmetric"].get<bool>() ? "yes" : "", cell(item["axes"][0]["count"]),
               cell(item["gross_errors"]),
               std::int64_t{model["components"].get<int>() - model["offsets"].get<int>()},
               cell(model["clutter"]), cell(model["offsets"]), mean(lags),
               cell(correlation["dependent_frames"]), cell(correlation["dependent_frames_within"]),
               cell(correlation["outlier_run"]), cell(correlation["outlier_dependent_frames"])});
  }
  return table;
}

StudyTable axis_summary(const std::vector<Json>& items) {
  StudyTable table({"detector", "object", "axis", "unit", "mean", "sd", "robust_sd", "kurtosis",
                    "inlier sd", "bias sd", "dep frames", "within"});
  for (const Json& item : items) {
    const DetectorNoise noise = noise_from_json(chosen_model(item)["noise"]);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const Json& a = item["axes"][axis];
      const Json& c = item["correlation"]["axes"][axis];
      const auto at = static_cast<Eigen::Index>(axis);
      const double sd = std::sqrt(noise.components().front().covariance(at, at));
      table.add({cell(item["detector"]), cell(item["object"]), kNoiseAxes[axis],
                 unit_of(item, axis), cell(a["mean"]), cell(a["sd"]), cell(a["robust_sd"]),
                 cell(a["kurtosis"]), axis < 3 ? degrees(sd) : sd, cell(c["bias_sd"]),
                 cell(c["dependent_frames"]), cell(c["dependent_frames_within"])});
    }
  }
  return table;
}

void add_tables(const std::vector<Json>& items, StudyReport& report) {
  const StudyTable axes = axis_table(items);
  report.files.push_back({"study.json", format_study("noise", axes)});
  report.files.push_back({"noise.csv", axes.csv()});
  constexpr std::array kModels{"components",     "offsets", "clutter",       "parameters",
                               "log_likelihood", "bic",     "bic_effective", "iterations",
                               "status",         "chosen"};
  report.files.push_back({"models.csv", group_table(items, "models", kModels).csv()});
  report.files.push_back(
      {"correlation.csv", group_table(items, "correlation", kGroupCorrelationColumns).csv()});
  constexpr std::array kModes{"weight",          "angle_deg",       "axis_x",
                              "axis_y",          "axis_z",          "translation_x_m",
                              "translation_y_m", "translation_z_m", "rotation_sd_deg",
                              "recordings",      "accepted"};
  const StudyTable modes = group_table(items, "modes", kModes);
  if (!modes.rows().empty()) report.files.push_back({"modes.csv", modes.csv()});
  constexpr std::array kFolds{"frame",       "clutter",    "components",
                              "log_density", "below_best", "standard_error"};
  const StudyTable folds = group_table(items, "validation", kFolds);
  if (!folds.rows().empty()) {
    report.files.push_back({"validation.csv", folds.csv()});
    report.summary += "Held-out log density per detection [nats]:\n" + folds.text(4) + "\n";
  }
  report.summary +=
      "Rotations in deg, translations in m or of the range. Truth `proxy`: the mean of the "
      "detections themselves.\n" +
      axis_summary(items).text(3) + "\nModels, and the number of frames that count as one:\n" +
      summary_table(items).text(3);
}

}  // namespace

StudyReport report_noise(std::span<const std::string> results) {
  std::vector<Json> items;
  std::optional<Json> odometry;
  for (const std::string& result : results) {
    Json item = Json::parse(result);
    if (item.contains("windows")) {
      odometry = std::move(item);
    } else {
      items.push_back(std::move(item));
    }
  }
  StudyReport report;
  add_tables(items, report);
  report_slow_errors(items, report);
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
  if (odometry) report_odometry(*odometry, report);
  return report;
}

}  // namespace posemix
