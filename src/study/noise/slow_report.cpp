// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/slow_report.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "posemix/base/units.hpp"
#include "study/engine/settings_json.hpp"
#include "study/engine/table.hpp"
#include "study/noise/json.hpp"
#include "study/noise/report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kPartColumns{"white_sd",      "white_sd_error", "slow_sd",
                                  "slow_sd_error", "common_sd",      "common_sd_error"};

double finite_or(const Json& json, double otherwise) {
  return json.is_number() ? json.get<double>() : otherwise;
}

Matrix6d covariance_from(const Json& json) {
  Matrix6d matrix;
  for (Eigen::Index row = 0; row < 6; ++row) {
    for (Eigen::Index column = 0; column < 6; ++column)
      matrix(row, column) =
          json.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column));
  }
  return matrix;
}

/// Degrees of radians for rotations.
Json in_degrees(const Vector6d& values) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < 6; ++i)
    json.push_back(finite_json(i < 3 ? degrees(values[i]) : values[i]));
  return json;
}

/// Models that differ by less are not told apart.
Json to_tenths(double nats) { return finite_json(0.1 * std::round(10.0 * nats)); }

Cell number_cell(const Json& json) {
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  return {};
}

std::string text_of(const Json& item, const char* key) { return item[key].get<std::string>(); }

std::string unit_of_part(const Json& item, std::size_t axis) {
  if (axis < 3) return "deg";
  return item["frame"] == "ray" ? "range" : "m";
}

/// Errors in common are along the object's axes, and their translations in metres.
StudyTable part_table(const std::vector<Json>& items) {
  std::vector<std::string> names{"detector", "object", "axis", "unit"};
  names.insert(names.end(), kPartColumns.begin(), kPartColumns.end());
  StudyTable table(names);
  for (const Json& item : items) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      std::vector<Cell> row{text_of(item, "detector"), text_of(item, "object"), kNoiseAxes[axis],
                            unit_of_part(item, axis)};
      for (const char* column : kPartColumns)
        row.push_back(number_cell(item["slow_error"][column][axis]));
      table.add(std::move(row));
    }
  }
  return table;
}

/// Run length of the component that is not the inlier; one where there is none.
double run_length_of(const DetectorNoise& noise) {
  double longest = 1.0;
  for (const NoiseComponent& component : noise.components())
    longest = std::max(longest, component.run_length);
  return longest;
}

StudyTable dependence_table(const std::vector<Json>& items) {
  StudyTable table({"detector", "object", "inliers", "recordings", "jackknife", "decay",
                    "correlation_angle_deg", "correlation_angle_error_deg", "correlation_time_s",
                    "correlation_time_error_s", "run_length", "mode_time_s", "clutter"});
  for (const Json& item : items) {
    const Json& fit = item["slow_error"];
    const DetectorNoise noise = dependent_noise_from_json(item["noise"]);
    table.add({text_of(item, "detector"), text_of(item, "object"), number_cell(fit["detections"]),
               number_cell(fit["recordings"]), std::int64_t{fit["jackknife"].get<bool>() ? 1 : 0},
               text_of(fit, "decay"), number_cell(fit["correlation_angle_deg"]),
               number_cell(fit["correlation_angle_error_deg"]),
               number_cell(fit["correlation_time_s"]), number_cell(fit["correlation_time_error_s"]),
               run_length_of(noise), noise.dependence().mode_time_s, noise.clutter().weight});
  }
  return table;
}

StudyTable model_table(const std::vector<Json>& items) {
  StudyTable table({"detector", "object", "decay", "common", "log_likelihood", "parameters", "bic",
                    "below_best", "standard_error", "chosen"});
  for (const Json& item : items) {
    for (const Json& model : item["slow_error"]["models"]) {
      table.add({text_of(item, "detector"), text_of(item, "object"), text_of(model, "decay"),
                 std::int64_t{model["common"].get<bool>() ? 1 : 0},
                 number_cell(model["log_likelihood"]), number_cell(model["parameters"]),
                 number_cell(model["bic"]), number_cell(model["below_best"]),
                 number_cell(model["standard_error"]),
                 std::int64_t{model["chosen"].get<bool>() ? 1 : 0}});
    }
  }
  return table;
}

std::string errors_text(const Json& errors) {
  const auto triple = [&](std::size_t first) {
    std::string text;
    for (std::size_t i = first; i < first + 3; ++i) {
      if (i > first) text += ", ";
      text += errors[i].is_number() ? fmt::format("{:.2g}", errors[i].get<double>()) : "-";
    }
    return text;
  };
  return fmt::format("rotation [{}] deg, translation [{}]", triple(0), triple(3));
}

}  // namespace

nlohmann::ordered_json dependent_noise_json(const DetectorNoise& noise) {
  const NoiseDependence& dependence = noise.dependence();
  Json json = {{"components", noise_json(noise)}, {"mode_time_s", dependence.mode_time_s}};
  if (dependence.slow) {
    json["slow"] = {{"covariance", matrix_json(dependence.slow->covariance)},
                    {"time_s", finite_json(dependence.slow->correlation_time_s)},
                    {"angle_rad", finite_json(dependence.slow->correlation_angle_rad)}};
  }
  if (dependence.common) json["common"] = matrix_json(*dependence.common);
  return json;
}

DetectorNoise dependent_noise_from_json(const nlohmann::ordered_json& json) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const DetectorNoise mixture = noise_from_json(json.at("components"));
  NoiseDependence dependence{.mode_time_s = json.at("mode_time_s")};
  if (json.contains("slow")) {
    const Json& slow = json["slow"];
    dependence.slow =
        SlowError{.covariance = covariance_from(slow.at("covariance")),
                  .correlation_time_s = finite_or(slow.at("time_s"), kInfinity),
                  .correlation_angle_rad = finite_or(slow.at("angle_rad"), kInfinity)};
  }
  if (json.contains("common")) dependence.common = covariance_from(json["common"]);
  return DetectorNoise(mixture.components(), mixture.clutter(), dependence);
}

nlohmann::ordered_json slow_error_json(const SlowErrorFit& fit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const SlowError slow = fit.slow.value_or(
      SlowError{.correlation_time_s = kInfinity, .correlation_angle_rad = kInfinity});
  Json json = {
      {"detections", fit.detections},
      {"recordings", fit.recordings},
      {"jackknife", fit.is_jackknife},
      {"decay", "none"},
      {"white_sd", in_degrees(fit.white_sd)},
      {"white_sd_error", in_degrees(fit.white_sd_error)},
      {"slow_sd", in_degrees(fit.slow_sd)},
      {"slow_sd_error", in_degrees(fit.slow_sd_error)},
      {"common_sd", in_degrees(fit.common_sd)},
      {"common_sd_error", in_degrees(fit.common_sd_error)},
      {"correlation_angle_deg", finite_json(degrees(slow.correlation_angle_rad))},
      {"correlation_angle_error_deg", finite_json(degrees(fit.correlation_angle_error_rad))},
      {"correlation_time_s", finite_json(slow.correlation_time_s)},
      {"correlation_time_error_s", finite_json(fit.correlation_time_error_s)},
      {"models", Json::array()}};
  for (std::size_t i = 0; i < fit.models.size(); ++i) {
    const SlowErrorModel& model = fit.models[i];
    if (i == fit.chosen) json["decay"] = word_of(model.decay);
    json["models"].push_back({{"decay", word_of(model.decay)},
                              {"common", model.common},
                              {"log_likelihood", model.log_likelihood},
                              {"parameters", model.parameters},
                              {"bic", model.bic},
                              {"below_best", to_tenths(model.below_best)},
                              {"standard_error", to_tenths(model.standard_error)},
                              {"chosen", i == fit.chosen}});
  }
  return json;
}

void report_slow_errors(const std::vector<nlohmann::ordered_json>& items, StudyReport& report) {
  const StudyTable parts = part_table(items);
  const StudyTable dependence = dependence_table(items);
  report.files.push_back({"slow_error.csv", parts.csv()});
  report.files.push_back({"dependence.csv", dependence.csv()});
  // No CSV: the last digits of models that are not chosen depend on how a search ends.
  report.files.push_back({"slow_models.txt", model_table(items).text(6)});
  report.summary +=
      "\nWhite, slow and common errors of inliers, with standard errors; common along the object's "
      "axes [deg, m]:\n" +
      parts.text(3) +
      "\nWhat the slow error decays with, and how long gross errors and modes last:\n" +
      dependence.text(3);
}

std::string slow_error_comment(const nlohmann::ordered_json& item) {
  const Json& fit = item["slow_error"];
  std::string text =
      fmt::format("# {} inliers in {} recordings. Standard errors of the inlier: {}.\n",
                  fit["detections"].get<std::int64_t>(), fit["recordings"].get<std::int64_t>(),
                  errors_text(fit["white_sd_error"]));
  if (item["noise"].contains("slow")) {
    text += fmt::format("# Of the slow error: {}", errors_text(fit["slow_sd_error"]));
    if (fit["correlation_angle_error_deg"].is_number()) {
      text += fmt::format(", correlation angle {:.2g} deg",
                          fit["correlation_angle_error_deg"].get<double>());
    }
    if (fit["correlation_time_error_s"].is_number()) {
      text +=
          fmt::format(", correlation time {:.2g} s", fit["correlation_time_error_s"].get<double>());
    }
    text += ".\n";
  }
  if (item["noise"].contains("common"))
    text += fmt::format("# Of the error in common: {}.\n", errors_text(fit["common_sd_error"]));
  return text;
}

}  // namespace posemix
