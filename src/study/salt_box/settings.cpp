// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <set>

#include <fmt/format.h>

#include "study.hpp"

namespace posemix {
namespace {

/// A quaternion w x y z, normalised.
SO3d read_rotation(const TomlTable& table, std::string_view key) {
  const Eigen::VectorXd q = table.get_vector(key, 4, {.lowest = -1.001, .highest = 1.001});
  if (std::abs(q.norm() - 1.0) > 1e-3) {
    table.fail(key, fmt::format("has norm {}, expected a unit quaternion w, x, y, z", q.norm()));
  }
  return SO3d::from_quaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
}

SaltBoxFeature read_feature(const TomlTable& table) {
  const NumberRange metres{.lowest = -1000, .highest = 1000};
  return {table.get_string("name"), table.get_vector("point_m", 3, metres),
          SE3d(read_rotation(table, "detected_quaternion_wxyz"),
               table.get_vector("detected_translation_m", 3, metres))};
}

void check_names(const TomlTable& table, const std::vector<SaltBoxFeature>& features) {
  constexpr std::size_t kLongestName = 80;
  std::set<std::string> names;
  for (const SaltBoxFeature& feature : features) {
    const bool plain = feature.name.size() <= kLongestName &&
                       feature.name.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") ==
                           std::string::npos;
    if (feature.name.empty() || !plain || !names.insert(feature.name).second) {
      table.fail(
          "features",
          fmt::format("has the name '{}', expected names of up to 80 letters, digits, - and _ that "
                      "differ",
                      feature.name));
    }
  }
  if (features.size() < 2) table.fail("features", "expected at least two");
}

std::size_t read_count(const TomlTable& table, std::string_view key, std::size_t otherwise,
                       std::int64_t lowest) {
  return static_cast<std::size_t>(table.get_integer_or(key, static_cast<std::int64_t>(otherwise),
                                                       {.lowest = lowest, .highest = 100000}));
}

void read_features(const TomlTable& table, SaltBoxSettings& settings) {
  if (table.has("features")) {
    settings.features.clear();
    for (const TomlTable& feature : table.get_tables("features")) {
      settings.features.push_back(read_feature(feature));
    }
    check_names(table, settings.features);
  }
  const auto angle = [&](std::string_view key, double otherwise) {
    return radians(table.get_double_or(key, degrees(otherwise), {.lowest = 0.01, .highest = 60}));
  };
  settings.tilt_sd = angle("tilt_sd_deg", settings.tilt_sd);
  settings.spin_sd = angle("spin_sd_deg", settings.spin_sd);
  settings.cone = angle("cone_deg", settings.cone);
  const NumberRange length{.lowest = 1e-6, .highest = 10};
  settings.lateral_sd = table.get_double_or("lateral_sd_m", settings.lateral_sd, length);
  settings.depth_sd = table.get_double_or("depth_sd_m", settings.depth_sd, length);
  settings.trial_depth_sd =
      table.get_double_or("trial_depth_sd_m", settings.trial_depth_sd, length);
}

void read_rules(const TomlTable& table, SaltBoxSettings& settings) {
  settings.composition = table.get_enum_or("composition", settings.composition);
  settings.fusion = table.get_enum_or("fusion", settings.fusion);
  settings.pair = table.get_enum_or("pair", settings.pair);
  settings.merge = table.get_enum_or("merge", settings.merge);
}

}  // namespace

SaltBoxSettings read_salt_box_settings(const TomlTable& table) {
  SaltBoxSettings settings = default_salt_box();
  read_features(table, settings);
  read_rules(table, settings);
  settings.drop = read_count(table, "drop", settings.drop, 0);
  settings.keep = read_count(table, "keep", settings.keep, 1);
  settings.flags = read_count(table, "flags", settings.flags, 0);
  settings.trials = read_count(table, "trials", settings.trials, 0);
  settings.seed = static_cast<std::uint64_t>(table.get_integer_or("seed", 1, {.lowest = 0}));
  return settings;
}

}  // namespace posemix
