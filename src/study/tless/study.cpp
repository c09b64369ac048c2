// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"
#include "posemix/io/bop_models.hpp"
#include "report.hpp"
#include "run.hpp"
#include "scene.hpp"

namespace posemix {
namespace {

/// Everything that determines the result, except for the contents of the recordings.
std::string tless_settings_text(const TlessStudySettings& s,
                                const std::vector<TlessScene>& scenes) {
  nlohmann::ordered_json json = {{"data", s.data.string()},
                                 {"least_score", s.least_score},
                                 {"seed", s.seed},
                                 {"odometry_rotation_sd_deg", s.odometry_rotation_sd_deg},
                                 {"odometry_translation_sd_m", s.odometry_translation_sd_m},
                                 {"match_m", s.match_m}};
  for (const TlessScene& scene : scenes)
    json["scenes"].push_back({scene.scene, scene.images.size()});
  for (const auto& [object, group] : s.symmetries) {
    auto& entry = json["symmetries"][std::to_string(object)];
    for (const SE3d& element : group.elements()) {
      const Vector6d twist = element.log();
      entry.push_back(std::vector<double>(twist.begin(), twist.end()));
    }
    for (const SymmetryAxis& axis : group.axes()) {
      entry.push_back(std::vector<double>(axis.direction.begin(), axis.direction.end()));
      entry.push_back(std::vector<double>(axis.point.begin(), axis.point.end()));
    }
  }
  for (const auto& [object, corners] : s.corners) {
    auto& entry = json["corners"][std::to_string(object)];
    for (const Eigen::Vector3d& corner : corners)
      entry.push_back(std::vector<double>(corner.begin(), corner.end()));
  }
  return json.dump();
}

std::vector<TlessScene> select_scenes(const TlessStudySettings& settings) {
  std::vector<TlessScene> scenes = read_tless(settings.data, settings.least_score);
  const auto is_there = [&](std::int64_t number) {
    return std::any_of(scenes.begin(), scenes.end(),
                       [&](const TlessScene& scene) { return scene.scene == number; });
  };
  for (const std::int64_t number : settings.scenes) {
    if (!is_there(number)) {
      throw InvalidInput(fmt::format("{}: has no T-LESS scene {}", settings.data.string(), number));
    }
  }
  if (settings.scenes.empty()) return scenes;
  std::erase_if(scenes, [&](const TlessScene& scene) {
    return std::find(settings.scenes.begin(), settings.scenes.end(), scene.scene) ==
           settings.scenes.end();
  });
  return scenes;
}

std::vector<std::int64_t> read_scenes(const TomlTable& table) {
  std::vector<std::int64_t> scenes;
  if (!table.has("scenes")) return scenes;
  for (const double number : table.get_vector("scenes", {}, {.lowest = 0.0, .highest = 1e6})) {
    if (number != std::floor(number)) table.fail("scenes", "expected whole numbers");
    scenes.push_back(static_cast<std::int64_t>(number));
  }
  return scenes;
}

}  // namespace

TlessStudySettings read_tless_settings(const TomlTable& table) {
  TlessStudySettings s;
  s.scenes = read_scenes(table);
  s.least_score = table.get_double_or("least_score", s.least_score);
  s.seed = static_cast<std::uint64_t>(table.get_integer_or("seed", 1, {.lowest = 0}));
  if (const auto odometry = table.find_table("odometry")) {
    s.odometry_rotation_sd_deg = odometry->get_double_or(
        "rotation_sd_deg", s.odometry_rotation_sd_deg, {.lowest = 1e-6, .highest = 180.0});
    s.odometry_translation_sd_m = odometry->get_double_or(
        "translation_sd_m", s.odometry_translation_sd_m, {.lowest = 1e-9, .highest = 100.0});
  }
  s.match_m = table.get_double_or("match_m", s.match_m, {.lowest = 1e-6, .highest = 100.0});
  s.symmetries = tless_symmetries();
  if (table.has("models_info")) {
    s.symmetries.clear();
    for (const auto& [object, model] : read_bop_models(table.get_string("models_info"))) {
      s.symmetries.emplace(object, model.symmetries);
      if (model.box) s.corners.emplace(object, model.box->corners());
    }
  }
  if (table.has("symmetries")) s.symmetries = read_symmetry_file(table.get_string("symmetries"));
  return s;
}

Study make_tless_study(const TlessStudySettings& settings) {
  const auto scenes = std::make_shared<const std::vector<TlessScene>>(select_scenes(settings));
  Study study;
  study.name = "tless";
  study.settings = tless_settings_text(settings, *scenes);
  study.items = 2 * scenes->size();
  study.run_item = [settings, scenes](std::size_t index) {
    return run_tless(scenes->at(index / 2), settings, index % 2 == 0).dump();
  };
  study.report = report_tless;
  return study;
}

}  // namespace posemix
