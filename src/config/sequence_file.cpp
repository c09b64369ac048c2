// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/sequence_file.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "sequence_parts.hpp"

namespace posemix {
namespace {

using namespace internal;

void check_schema(const TomlTable& root) {
  const std::int64_t schema = root.get_integer("schema");
  if (schema == kSequenceSchema) return;
  root.fail("schema",
            fmt::format("is {}, expected {}: this is another version of the sequence file", schema,
                        kSequenceSchema));
}

/// The name of the file, or of its folder if the file is named "sequence", and of the recording.
std::string read_name(const TomlDocument& document, const TomlTable& root) {
  std::filesystem::path path = std::filesystem::path(document.name()).replace_extension();
  while (path.filename() == "sequence" && path.parent_path().has_filename())
    path = path.parent_path();
  const std::string name = path.filename().string();
  const std::string recording = root.get_string_or("sequence", "");
  return name.find(recording) == std::string::npos ? name + " " + recording : name;
}

/// The tables [[objects]], of which there need be none where observations name objects.
std::vector<TomlTable> object_tables(const TomlTable& root) {
  const bool none_needed = root.has("on_sight") || root.has("observations");
  return none_needed ? root.find_tables("objects") : root.get_tables("objects");
}

std::vector<std::string> ids_of(const std::vector<ObjectModel>& models) {
  std::vector<std::string> ids;
  ids.reserve(models.size());
  for (const ObjectModel& model : models) ids.push_back(model.id);
  return ids;
}

/// Tables that need observations.
void require_meaning(const TomlTable& root, const ObservedRecording& observed) {
  if (!observed.files.empty()) return;
  for (const char* key : {"cameras", "on_sight"}) {
    if (root.has(key))
      root.fail(key, "is for observations, expected a table [[observations]] beside it");
  }
}

/// What the file says of observations, and models of the objects that they name and that are not
/// declared.
ObservedRecording read_observed(const TomlTable& root, const FileFinder& files,
                                const std::map<std::string, DetectorNoise>& noise_models,
                                const std::vector<FrameFile>& frames,
                                std::vector<ObjectModel>& models) {
  ObservedRecording observed{read_observation_files(root, files), read_body_cameras(root)};
  require_meaning(root, observed);
  const auto table = root.find_table("on_sight");
  require_known_objects(observed.files, models, table.has_value());
  if (table) {
    ObjectModel model = read_model_on_sight(*table, files, noise_models, frames);
    for (const std::string& id : ids_on_sight(observed.files, ids_of(models))) {
      model.id = id;
      models.push_back(model);
    }
  }
  require_known_sources(observed, models);
  return observed;
}

/// Every class of candidates must have objects, and every class of objects candidates.
void check_classes(const TomlTable& root, const SlamJob& job, bool multi_object) {
  std::set<std::string> named;
  for (const auto& frame : job.sequence.observations)
    for (const Observation& observation : frame) named.insert(observation.class_id);
  for (const TomlTable& table : root.find_tables("candidates")) {
    named.insert(table.get_string("class"));
    if (!multi_object)
      table.fail("class",
                 "is for filter.method = \"multi_object\" alone: no other filter tells "
                 "the instances of a class apart");
  }
  std::set<std::string> classes;
  const std::vector<TomlTable> objects = object_tables(root);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::string& name = job.models[i].class_id;
    classes.insert(name);
    if (objects[i].has("class") && !named.contains(name))
      objects[i].fail(
          "class",
          fmt::format(
              "is {}, but no table [[candidates]] has that class and no observation names it",
              in_quotes(name)));
    if (multi_object) {
      located(objects[i], "id", [&] {
        require_alike_in_class(std::span<const ObjectModel>(job.models).first(i + 1));
      });
    }
  }
  for (const TomlTable& table : root.find_tables("candidates")) {
    const std::string name = table.get_string("class");
    if (name.empty() || !classes.contains(name))
      table.fail("class", fmt::format("is {}, but no object has that class", in_quotes(name)));
  }
}

/// The joint use of noise needs detectors with the same number of noise components and the same
/// weights.
void check_joint_noise(const TomlTable& root, const SlamJob& job) {
  const auto* filter = std::get_if<GaussianSumSettings>(&job.settings.tracker);
  if (filter == nullptr || filter->noise_use != NoiseUse::joint) return;
  const auto& first = job.models.front().noise.components();
  for (const ObjectModel& model : job.models) {
    const auto& other = model.noise.components();
    const bool same = std::equal(first.begin(), first.end(), other.begin(), other.end(),
                                 [](const NoiseComponent& a, const NoiseComponent& b) {
                                   return std::abs(a.weight - b.weight) < 1e-12;
                                 });
    if (same) continue;
    const TomlTable table = root.get_table("filter");
    const bool by_key = table.has("noise_use");
    table.fail(by_key ? "noise_use" : "method",
               fmt::format("{}, which needs noise models with equal weights, but those of objects "
                           "'{}' and '{}' differ",
                           by_key ? "is \"joint\"" : "has noise_use = \"joint\"",
                           job.models.front().id, model.id));
  }
}

/// Every object needs detections, because the multi-object filter starts objects from them.
void check_starts(const TomlTable& root, const SlamJob& job) {
  const std::vector<TomlTable> objects = object_tables(root);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!job.models[i].independent_start) continue;
    objects[i].fail("start",
                    "is for filter.method = \"gm-iekf\" and its kin; the multi-object filter "
                    "starts objects from their detections");
  }
}

bool is_multi_object(const SlamMethod& method) {
  return std::holds_alternative<MultiObjectSlamSettings>(method.tracker);
}

void use_method(const TomlTable& root, const SlamMethod& method, SlamJob& job) {
  if (method.single_gaussian) {
    located(root.get_table("filter"), "method", [&] { job.use(method); });
  } else {
    job.use(method);
  }
  if (is_multi_object(method)) check_starts(root, job);
  check_joint_noise(root, job);
}

/// Models of the [[objects]].
std::vector<ObjectModel> read_models(const TomlTable& root, const FileFinder& files,
                                     const SlamMethod& method,
                                     const std::map<std::string, DetectorNoise>& noise_models,
                                     const std::vector<FrameFile>& frames) {
  const std::vector<TomlTable> tables = object_tables(root);
  for (const TomlTable& object : tables) {
    if (object.has("prior") && !is_multi_object(method))
      object.fail("prior", "is for the multi-object filter; expected none with another method");
  }
  return read_object_models(tables, files, noise_models, frames);
}

/// What the file says of the camera, which has to fit what was observed.
CameraFiles read_camera(const TomlTable& root, const FileFinder& files,
                        const ObservedRecording& observed, const std::vector<ObjectModel>& models) {
  CameraFiles camera = read_camera_files(root, files);
  require_one_clock(observed, camera);
  if (camera.images) camera.images->require_known_detectors(observed.cameras, models);
  return camera;
}

/// Checks how the objects of the file, and those on sight, may move.
void check_motions(const TomlTable& root, const SlamMethod& method, const SlamJob& job) {
  const std::vector<TomlTable> objects = object_tables(root);
  for (std::size_t i = 0; i < objects.size(); ++i)
    check_motion(objects[i], job.models[i], job, method);
  if (const auto table = root.find_table("on_sight"); table && job.models.size() > objects.size())
    check_motion(*table, job.models.back(), job, method);
}

}  // namespace

SlamJob read_slam_job(const TomlDocument& document,
                      const std::vector<std::filesystem::path>& folders) {
  const TomlTable root = document.root();
  check_schema(root);
  const FileFinder files(folders, root.get_strings_or("roots", {"."}));
  const SlamMethod method = read_filter(root);
  auto noise_models = read_noise_models(root);
  if (const auto* tracker = std::get_if<MultiObjectSlamSettings>(&method.tracker)) {
    std::set<std::string> used;
    for (const TomlTable& object : object_tables(root)) add_used_noise(object, used);
    if (const auto table = root.find_table("on_sight")) add_used_noise(*table, used);
    assume_missing(root, used, tracker->filter.default_clutter, noise_models);
  }
  const std::vector<FrameFile> frames = read_known_frames(root, files);
  std::vector<ObjectModel> models = read_models(root, files, method, noise_models, frames);
  const ObservedRecording observed = read_observed(root, files, noise_models, frames, models);
  const CameraFiles camera = read_camera(root, files, observed, models);
  SlamJob job{.name = read_name(document, root),
              .method = {},
              .sequence = {},
              .camera_prior = PoseDensity(SE3d(), Matrix6d::Identity()),
              .models = std::move(models),
              .settings = {}};
  job.sequence = read_recordings(root, files, camera, ids_of(job.models), observed, frames);
  job.camera_prior = starts_anywhere(root) ? prior_anywhere(root, job.models)
                                           : read_camera_prior(root, job.sequence.camera_truth);
  job.settings.motion = read_motion(root, camera.odometry.has_value());
  check_classes(root, job, is_multi_object(method));
  use_method(root, method, job);
  if (auto* tracker = std::get_if<MultiObjectSlamSettings>(&job.settings.tracker)) {
    tracker->cameras = observed.cameras;
    for (const FrameFile& frame : frames) tracker->frames.push_back(frame.name);
  }
  check_motions(root, method, job);
  if (const auto output = root.find_table("output")) {
    job.trace_hypotheses = static_cast<std::size_t>(
        output->get_integer_or("trace_hypotheses", kTraceHypotheses, kAtLeastZero));
  }
  document.finish();
  return job;
}

}  // namespace posemix
