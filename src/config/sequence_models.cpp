// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

/// The models of objects.
namespace posemix::internal {
namespace {

/// The name of the noise model for objects that name none: default_detector_noise(), unless the
/// file has a table of this name.
constexpr std::string_view kDefaultNoise = "default";

std::string read_id(const TomlTable& object, std::set<std::string>& taken) {
  std::string id = object.get_string("id");
  if (!is_usable_id(id))
    object.fail("id", fmt::format("is {}, expected {}", in_quotes(id), kUsableId));
  if (!taken.insert(id).second) {
    object.fail("id", fmt::format("is {}, which another object has already", in_quotes(id)));
  }
  return id;
}

/// The pose that an object is known to have, with an error along its own axes.
ObjectPrior read_prior(const TomlTable& prior) {
  constexpr NumberRange kProbability{.lowest = 1e-6, .highest = 1.0};
  const SE3d pose = read_pose(prior, "pose");
  const Matrix6d covariance = pose.adjoint_congruence(read_pose_covariance(prior));
  ObjectPrior result{ConcentratedGaussian<SE3d>(pose, covariance)};
  result.probability = prior.get_double_or("probability", result.probability, kProbability);
  return result;
}

/// The noise models of several detectors of an object, by their names.
std::map<std::string, DetectorNoise> read_detectors(
    const TomlTable& object, const std::map<std::string, DetectorNoise>& noise_models) {
  std::map<std::string, DetectorNoise> detectors;
  const auto table = object.find_table("detectors");
  if (!table) return detectors;
  for (const std::string& name : table->keys())
    detectors.emplace(name, noise_of(*table, noise_models, name));
  return detectors;
}

ObjectModel read_model(const TomlTable& object, const FileFinder& files, std::set<std::string>& ids,
                       const std::map<std::string, DetectorNoise>& noise_models,
                       const std::vector<FrameFile>& frames) {
  std::string id = read_id(object, ids);
  DetectorNoise noise = noise_of(object, noise_models, "noise");
  std::optional<Matrix6d> start;
  if (const auto table = object.find_table("start")) start = read_pose_covariance(*table);
  ObjectModel model{std::move(id),
                    std::move(noise),
                    start,
                    read_object_symmetries(object, files),
                    object.get_string_or("class", ""),
                    read_detectors(object, noise_models)};
  if (const auto prior = object.find_table("prior"))
    model.prior = located(object, "prior", [&] { return read_prior(*prior); });
  model.motion = read_object_motion(object, frames);
  return model;
}

}  // namespace

DetectorNoise noise_of(const TomlTable& object,
                       const std::map<std::string, DetectorNoise>& noise_models,
                       const std::string& key) {
  const std::string noise = object.get_string_or(key, kDefaultNoise);
  const auto found = noise_models.find(noise);
  const bool built_in = found == noise_models.end() && noise == kDefaultNoise;
  if (found == noise_models.end() && !built_in) {
    object.fail(key, fmt::format("is {0}, but there is no table [noise.{1}]", in_quotes(noise),
                                 noise.empty() ? "NAME" : noise));
  }
  return built_in ? default_detector_noise() : found->second;
}

void add_used_noise(const TomlTable& object, std::set<std::string>& used) {
  used.insert(object.get_string_or("noise", kDefaultNoise));
  if (const auto detectors = object.find_table("detectors")) {
    for (const std::string& name : detectors->keys()) used.insert(detectors->get_string(name));
  }
}

std::vector<ObjectModel> read_object_models(
    const std::vector<TomlTable>& tables, const FileFinder& files,
    const std::map<std::string, DetectorNoise>& noise_models,
    const std::vector<FrameFile>& frames) {
  std::vector<ObjectModel> models;
  models.reserve(tables.size());
  std::set<std::string> ids;
  for (const TomlTable& table : tables)
    models.push_back(read_model(table, files, ids, noise_models, frames));
  return models;
}

ObjectModel read_model_on_sight(const TomlTable& table, const FileFinder& files,
                                const std::map<std::string, DetectorNoise>& noise_models,
                                const std::vector<FrameFile>& frames) {
  ObjectModel model;
  model.noise = noise_of(table, noise_models, "noise");
  model.detectors = read_detectors(table, noise_models);
  model.symmetries = read_object_symmetries(table, files);
  model.motion = read_object_motion(table, frames);
  return model;
}

}  // namespace posemix::internal
