// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/config/detector_noise.hpp"
#include "report.hpp"
#include "study/engine/settings_json.hpp"
#include "study/engine/settings_toml.hpp"
#include "trial.hpp"

namespace posemix {
namespace {

constexpr IntegerRange kCount{.lowest = 1, .highest = 10'000'000};
constexpr NumberRange kLength{.lowest = 1e-3, .highest = 1e6};
constexpr NumberRange kExponent{.lowest = -12, .highest = 12};

std::size_t read_count(const TomlTable& table, std::string_view key, std::size_t otherwise) {
  return static_cast<std::size_t>(
      table.get_integer_or(key, static_cast<std::int64_t>(otherwise), kCount));
}

MonteCarloPath read_path(const TomlTable& table) {
  MonteCarloPath path;
  path.radius_m = table.get_double_or("radius_m", path.radius_m, kLength);
  path.height_m = table.get_double_or("height_m", path.height_m, {.lowest = -1e6, .highest = 1e6});
  path.height_swing_m =
      table.get_double_or("height_swing_m", path.height_swing_m, {.lowest = 0, .highest = 1e6});
  path.turns = read_count(table, "turns", path.turns);
  path.detections = read_count(table, "detections", path.detections);
  path.odometry_per_detection =
      read_count(table, "odometry_per_detection", path.odometry_per_detection);
  path.detection_period_s = table.get_double_or("detection_period_s", path.detection_period_s,
                                                {.lowest = 1e-6, .highest = 1e6});
  return path;
}

Matrix6d read_covariance_or(const TomlTable& table, std::string_view key, const Matrix6d& other) {
  const auto found = table.find_table(key);
  return found ? read_pose_covariance(*found) : other;
}

}  // namespace

MonteCarloStudySettings read_monte_carlo_settings(const TomlTable& table) {
  MonteCarloStudySettings settings;
  settings.runs = read_count(table, "runs", settings.runs);
  settings.methods = table.get_strings_or("methods", settings.methods);
  if (settings.methods.empty()) table.fail("methods", "is empty, expected at least one name");
  for (auto at = settings.methods.begin(); at != settings.methods.end(); ++at) {
    std::string& name = *at;
    std::replace(name.begin(), name.end(), '-', '_');
    if (std::find(settings.methods.begin(), at, name) != at)
      table.fail("methods", fmt::format("has '{}' again, expected every method once", name));
    try {
      monte_carlo_method(name, settings);
    } catch (const InvalidInput& error) {
      table.fail("methods", fmt::format("is not valid: {}", error.what()));
    }
  }
  settings.noise_exponents =
      read_numbers(table, "noise_exponents", settings.noise_exponents, kExponent);
  settings.seed = static_cast<std::uint64_t>(
      table.get_integer_or("seed", static_cast<std::int64_t>(settings.seed), kAtLeastZero));
  settings.max_components = read_count(table, "max_components", settings.max_components);
  settings.prune_below =
      table.get_double_or("prune_below", settings.prune_below, ReductionSettings::kPruneBelow);
  if (const auto path = table.find_table("path")) settings.path = read_path(*path);
  settings.odometry = read_covariance_or(table, "odometry", settings.odometry);
  settings.camera_start = read_covariance_or(table, "camera_start", settings.camera_start);
  settings.object_start = read_covariance_or(table, "object_start", settings.object_start);
  if (const auto detector = table.find_table("detector")) {
    settings.detector = read_detector_noise(*detector);
  }
  check_monte_carlo_settings(settings);
  return settings;
}

void check_monte_carlo_settings(const MonteCarloStudySettings& settings) {
  require(settings.runs > 0, "monte-carlo: runs is 0, expected at least 1");
  require(!settings.methods.empty(), "monte-carlo: there is no method");
  require(!settings.noise_exponents.empty(), "monte-carlo: there is no noise exponent");
  require(settings.path.detections > 0 && settings.path.odometry_per_detection > 0,
          "monte-carlo: there is no detection, or no odometry");
  for (auto name = settings.methods.begin(); name != settings.methods.end(); ++name) {
    monte_carlo_method(*name, settings);
    if (std::find(settings.methods.begin(), name, *name) != name) {
      throw InvalidInput(fmt::format("monte-carlo: method '{}' is given twice", *name));
    }
  }
}

std::string monte_carlo_settings_json(const MonteCarloStudySettings& settings) {
  const MonteCarloPath& path = settings.path;
  const nlohmann::ordered_json json{{"runs", settings.runs},
                                    {"noise_exponents", settings.noise_exponents},
                                    {"methods", settings.methods},
                                    {"seed", settings.seed},
                                    {"path",
                                     {{"radius_m", path.radius_m},
                                      {"height_m", path.height_m},
                                      {"height_swing_m", path.height_swing_m},
                                      {"turns", path.turns},
                                      {"detections", path.detections},
                                      {"odometry_per_detection", path.odometry_per_detection},
                                      {"detection_period_s", path.detection_period_s}}},
                                    {"odometry", matrix_json(settings.odometry)},
                                    {"camera_start", matrix_json(settings.camera_start)},
                                    {"object_start", matrix_json(settings.object_start)},
                                    {"detector", noise_json(settings.detector)},
                                    {"max_components", settings.max_components},
                                    {"prune_below", settings.prune_below}};
  return json.dump();
}

}  // namespace posemix
