// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/config/noise_toml.hpp"
#include "study/engine/table.hpp"
#include "study/noise/figures.hpp"
#include "study/noise/groups.hpp"
#include "study/noise/json.hpp"
#include "study/noise/odometry_report.hpp"
#include "study/noise/slow_report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

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

constexpr std::string_view kNoiseQuestion =
    "How large are the errors of a detector, and which noise model has a filter to use for them?";

/// The model that is chosen for every object, and what to make of the units.
std::vector<std::string> noise_notes(const std::vector<Json>& items) {
  std::vector<std::string> notes{
      "Rotations are in deg, translations in m or, along the ray, in shares of the range."};
  const auto is_proxy = [](const Json& item) { return item["proxy"].get<bool>(); };
  if (std::any_of(items.begin(), items.end(), is_proxy)) {
    notes.emplace_back(
        "The truth `proxy` is the mean of the detections themselves: what they share is not in "
        "it.");
  }
  std::size_t several = 0;
  for (const Json& item : items) several += chosen_model(item)["components"] > 1 ? 1 : 0;
  notes.push_back(fmt::format(
      "The BIC chooses more than one component, that is tails wider than Gaussian, for {} of {} "
      "groups of detections.",
      several, items.size()));
  return notes;
}

void add_tables(const std::vector<Json>& items, StudyReport& report) {
  const StudyTable axes = axis_table(items);
  report.notes = noise_notes(items);
  report.files.push_back(
      {"study.json", format_study({"noise", kNoiseQuestion, report.notes}, axes)});
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
  report.summary += "Errors along each axis:\n" + axis_summary(items).text(3) +
                    "\nModels, and the number of frames that count as one:\n" +
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
    report.files.push_back({"noise_" + name + ".toml", toml_of(item, name)});
    report.files.push_back({"noise_" + name + ".svg", draw_residuals(item)});
  }
  if (odometry) report_odometry(*odometry, report);
  return report;
}

}  // namespace posemix
