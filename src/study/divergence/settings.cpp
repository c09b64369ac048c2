// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <fmt/format.h>

#include "study/engine/settings_toml.hpp"

namespace posemix {
namespace {

constexpr double kFinestGridDeg = 0.1;
constexpr NumberRange kSdDeg{.lowest = 0.01, .highest = 180};

Eigen::Vector3d read_sd_rad(const TomlTable& table, std::string_view key,
                            const Eigen::Vector3d& otherwise) {
  if (!table.has(key)) return otherwise;
  if (table.is_array(key)) return radians(1.0) * table.get_vector(key, 3, kSdDeg);
  return Eigen::Vector3d::Constant(radians(table.get_double(key, kSdDeg)));
}

}  // namespace

DivergenceStudySettings read_divergence_settings(const TomlTable& table) {
  DivergenceStudySettings settings;
  settings.phi_deg =
      read_numbers(table, "phi_deg", settings.phi_deg, {.lowest = -180, .highest = 180});
  if (table.has("weights")) {
    const Eigen::VectorXd weights = table.get_vector("weights", 2, kPositive);
    settings.weights = {weights[0], weights[1]};
  }
  if (table.has("direction")) {
    settings.direction = table.get_vector("direction", 3, {.lowest = -100, .highest = 100});
  }
  settings.first_sd_rad = read_sd_rad(table, "first_sd_deg", settings.first_sd_rad);
  settings.second_sd_rad = read_sd_rad(table, "second_sd_deg", settings.second_sd_rad);
  settings.relative_tolerance = table.get_double_or(
      "relative_tolerance", settings.relative_tolerance, {.lowest = 1e-12, .highest = 0.1});
  const double step = table.get_double_or("paper_grid_step_deg", settings.paper_grid_step_deg,
                                          {.lowest = 0, .highest = 30});
  if (step > 0.0 && step < kFinestGridDeg) {
    table.fail("paper_grid_step_deg",
               fmt::format("is {}, expected 0 or at least {}", step, kFinestGridDeg));
  }
  settings.paper_grid_step_deg = step;
  return settings;
}

}  // namespace posemix
