// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "scene.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "study/recordings/profiles.hpp"

namespace posemix {
namespace {

constexpr double kStampOfImageS = 0.1;

/// The rows of one scene by image.
std::map<std::int64_t, std::vector<BopRow>> rows_by_image(std::span<const BopRow> rows,
                                                          std::int64_t scene) {
  std::map<std::int64_t, std::vector<BopRow>> images;
  for (const BopRow& row : rows)
    if (row.scene == scene) images[row.image].push_back(row);
  return images;
}

/// Appends the instances as objects, by class and within a class in the order of appearance.
void add_objects(const StaticScene& placed, TlessScene& scene) {
  std::map<std::int64_t, std::vector<const StaticScene::Instance*>> classes;
  for (const StaticScene::Instance& instance : placed.instances)
    classes[instance.object].push_back(&instance);
  const std::size_t frames = scene.images.size();
  for (const auto& [object, instances] : classes) {
    for (std::size_t i = 0; i < instances.size(); ++i) {
      const std::string name = std::to_string(object);
      ObjectRecording recording;
      recording.id = instances.size() == 1 ? name : fmt::format("{}.{}", name, i);
      recording.detections.resize(frames);
      recording.relative_truth = instances[i]->camera_object;
      recording.world_truth.assign(frames, instances[i]->world_object);
      scene.sequence.objects.push_back(std::move(recording));
      scene.classes.push_back(name);
    }
  }
}

/// The one file of a folder whose name has all of the parts.
std::filesystem::path the_file(const std::filesystem::path& folder, std::string_view begin,
                               std::string_view part) {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with(begin) && name.ends_with(".csv") && name.find(part) != std::string::npos)
      found.push_back(it->path());
  }
  if (error) throw InvalidInput(fmt::format("{}: {}", folder.string(), error.message()));
  if (found.size() != 1) {
    throw InvalidInput(fmt::format("{}: holds {} files {}*{}*.csv, expected one", folder.string(),
                                   found.size(), begin, part));
  }
  return found.front();
}

}  // namespace

TlessScene tless_scene(std::int64_t scene, std::span<const BopRow> truth,
                       std::span<const BopRow> estimates, double least_score) {
  const auto true_rows = rows_by_image(truth, scene);
  if (true_rows.empty())
    throw InvalidInput(fmt::format("got no true pose of scene {}, expected at least one", scene));
  TlessScene result;
  result.scene = scene;
  std::vector<std::vector<BopRow>> images;
  for (const auto& [image, rows] : true_rows) {
    result.images.push_back(image);
    result.sequence.stamps.push_back(kStampOfImageS * static_cast<double>(image));
    images.push_back(rows);
  }
  const StaticScene placed = static_scene(images);
  result.sequence.camera_truth = placed.world_camera;
  add_objects(placed, result);
  const auto estimated = rows_by_image(estimates, scene);
  for (const std::int64_t image : result.images) {
    std::vector<Candidate>& candidates = result.candidates.emplace_back();
    const auto found = estimated.find(image);
    if (found == estimated.end()) continue;
    for (const BopRow& row : found->second) {
      if (row.score >= least_score)
        candidates.push_back({std::to_string(row.object), row.pose, row.score});
    }
  }
  validate(result.sequence);
  return result;
}

std::vector<TlessScene> read_tless(const std::filesystem::path& data, double least_score) {
  const std::filesystem::path folder = data / "bop_toolkit";
  const std::vector<BopRow> truth = read_bop_rows(the_file(folder, "gt-", "tless"));
  const std::vector<BopRow> estimates = read_bop_rows(the_file(folder, "", "megapose_tless"));
  std::set<std::int64_t> numbers;
  for (const BopRow& row : truth) numbers.insert(row.scene);
  std::vector<TlessScene> scenes;
  scenes.reserve(numbers.size());
  for (const std::int64_t number : numbers)
    scenes.push_back(tless_scene(number, truth, estimates, least_score));
  return scenes;
}

SymmetryGroups tless_symmetries() {
  return parse_symmetry_file(kTlessSymmetries, "configs/tless-symmetries.toml");
}

}  // namespace posemix
