// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/simulation_config.hpp"

#include <map>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "simulation_parts.hpp"

namespace posemix {
namespace {

using namespace internal;
using Eigen::Vector3d;

constexpr std::int64_t kSchema = 1;

constexpr IntegerRange kFrames{.lowest = 1, .highest = 10'000'000};
constexpr NumberRange kFramePeriod{.lowest = 1e-6, .highest = 3600};
constexpr NumberRange kWeight{.lowest = 1e-12, .highest = 1e12};
using NoiseModels = std::map<std::string, std::vector<SimulationNoise>>;

std::size_t get_count(const TomlTable& table, std::string_view key, std::size_t otherwise,
                      const IntegerRange& range) {
  return static_cast<std::size_t>(
      table.get_integer_or(key, static_cast<std::int64_t>(otherwise), range));
}

SimulationSwing get_swing(const TomlTable& parent, std::string_view key, SimulationSwing swing) {
  if (const auto table = parent.find_table(key)) {
    swing.mean_m = table->get_double_or("mean_m", swing.mean_m, kSimulationLength);
    swing.swing_m = table->get_double_or("swing_m", swing.swing_m, kSimulationLength);
    swing.waves = get_count(*table, "waves", swing.waves, kSimulationCount);
  }
  return swing;
}

SimulationPath get_path(const TomlTable& camera) {
  SimulationPath path;
  path.frames = get_count(camera, "frames", path.frames, kFrames);
  path.period_s = camera.get_double_or("period_s", path.period_s, kFramePeriod);
  path.turns = get_count(camera, "turns", path.turns, kSimulationCount);
  path.target_m = get_vector3(camera, "target_m", path.target_m);
  path.range = get_swing(camera, "range", path.range);
  path.height = get_swing(camera, "height", path.height);
  path.set_up = camera.get_enum_or("set_up", path.set_up);
  if (const auto arm = camera.find_table("arm")) path.arm = get_sd(*arm, path.arm);
  path.view = get_view(camera);
  return path;
}

SimulationNoise get_component(const TomlTable& table) {
  SimulationNoise noise;
  noise.weight = table.get_double_or("weight", noise.weight, kWeight);
  noise.frame = table.get_enum_or("frame", noise.frame);
  noise.sd = get_sd(table, noise.sd, noise.frame);
  if (const auto offset = table.find_table("offset")) {
    noise.offset_rotation_rad = get_rotation(*offset, "rotation_deg");
    noise.offset_translation_m = get_vector3(*offset, "translation_m", Vector3d::Zero());
  }
  return noise;
}

NoiseModels get_noise_models(const TomlTable& root) {
  NoiseModels models;
  const auto table = root.find_table("noise");
  if (!table) return models;
  for (const std::string& name : table->keys()) {
    for (const TomlTable& component : table->get_table(name).get_tables("components")) {
      models[name].push_back(get_component(component));
    }
  }
  return models;
}

/// The noise model whose name is under `key` of an object.
const std::vector<SimulationNoise>& named_noise(const NoiseModels& models, const TomlTable& object,
                                                std::string_view key) {
  const auto found = models.find(object.get_string(key));
  if (found == models.end()) {
    object.fail(key, fmt::format("names a noise model that is not there, [noise.{}]",
                                 object.get_string(key)));
  }
  return found->second;
}

std::optional<SimulationSlowError> get_slow(const TomlTable& object, NoiseFrame frame) {
  constexpr NumberRange kSlowCorrelation{
      .lowest = 0, .without_lowest = true, .with_infinity = true};
  const auto table = object.find_table("slow");
  if (!table) return std::nullopt;
  SimulationSlowError slow;
  slow.sd = get_sd(*table, slow.sd, frame);
  slow.correlation_s =
      table->get_double_or("correlation_time_s", slow.correlation_s, kSlowCorrelation);
  slow.correlation_angle_rad = radians(table->get_double_or(
      "correlation_angle_deg", degrees(slow.correlation_angle_rad), kSlowCorrelation));
  return slow;
}

SimulationObject get_object(const TomlTable& table, const NoiseModels& models) {
  SimulationObject object;
  object.id = get_name(table, "id");
  if (table.has("class")) object.class_id = get_name(table, "class");
  object.position_m = get_vector3(table, "position_m", object.position_m);
  object.rotation_rad = get_rotation(table, "rotation_deg");
  object.noise = named_noise(models, table, "noise");
  if (table.has("claimed_noise")) object.claimed = named_noise(models, table, "claimed_noise");
  object.correlation_s = table.get_double_or("correlation_s", 0.0, kSimulationTime);
  object.slow = get_slow(table, object.noise.front().frame);
  if (const auto flips = table.find_table("flips")) {
    object.flips.runs = get_runs(*flips);
    object.flips.rotation_rad = get_rotation(*flips, "rotation_deg");
    object.flips.translation_m = get_vector3(*flips, "translation_m", object.flips.translation_m);
  }
  if (const auto outliers = table.find_table("outliers")) {
    object.outliers.runs = get_runs(*outliers);
    object.outliers.box_m = outliers->get_vector_or("box_m", object.outliers.box_m, kSimulationBox);
  }
  if (const auto misses = table.find_table("misses")) object.misses = get_runs(*misses);
  object.hidden_frames = get_count(table, "hidden_frames", 0, kSimulationCount);
  get_motions(table, object);
  return object;
}

std::vector<SimulationObject> get_objects(const TomlTable& root, std::size_t frames) {
  std::vector<SimulationObject> objects;
  std::set<std::string> ids;
  const NoiseModels models = get_noise_models(root);
  for (const TomlTable& table : root.get_tables("objects")) {
    objects.push_back(get_object(table, models));
    const SimulationObject& object = objects.back();
    if (!ids.insert(object.id).second) {
      table.fail("id", fmt::format("is \"{}\", which another object has too", object.id));
    }
    if (object.hidden_frames >= frames) {
      table.fail("hidden_frames",
                 fmt::format("is {}, but there are only {} frames", object.hidden_frames, frames));
    }
  }
  return objects;
}

std::vector<std::pair<std::string, std::string>> get_filter(const TomlTable& root) {
  std::vector<std::pair<std::string, std::string>> settings;
  if (const auto filter = root.find_table("filter")) {
    for (const std::string& key : filter->keys()) settings.emplace_back(key, filter->text_of(key));
  }
  return settings;
}

}  // namespace

SimulationFile read_simulation(const TomlDocument& document) {
  const TomlTable root = document.root();
  root.get_integer("schema", {kSchema, kSchema});
  SimulationFile file;
  SimulationConfig& config = file.config;
  if (const auto camera = root.find_table("camera")) {
    config.path = get_path(*camera);
    if (const auto start = camera->find_table("start")) config.start = get_sd(*start, config.start);
  }
  if (const auto odometry = root.find_table("odometry")) {
    config.odometry = get_sd(*odometry, config.odometry);
  }
  if (const auto motion = root.find_table("motion")) {
    config.claimed_odometry = get_sd(motion->get_table("noise"), config.odometry);
  }
  config.objects = get_objects(root, config.path.frames);
  config.frames = get_frames(root);
  config.clutter = get_clutter(root);
  read_filter(root);
  document.finish();
  file.filter = get_filter(root);
  try {
    validate(config);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", document.name(), error.what()));
  }
  return file;
}

}  // namespace posemix
