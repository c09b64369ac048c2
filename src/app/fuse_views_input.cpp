// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "fuse_views_input.hpp"

#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/config/detector_noise.hpp"
#include "posemix/config/symmetries.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/io/dataset.hpp"
#include "study/tless/scene.hpp"

namespace posemix {
namespace {

namespace fs = std::filesystem;

using RowsByImage = std::map<std::pair<std::int64_t, std::int64_t>, std::vector<BopRow>>;

RowsByImage read_rows_by_image(const std::string& path) {
  RowsByImage images;
  for (const BopRow& row : read_bop_rows(path)) images[{row.scene, row.image}].push_back(row);
  return images;
}

/// The images of the results in groups of `size`, in the order of scene and image.
std::vector<ImageGroup> groups_of(const RowsByImage& images, std::size_t size) {
  std::vector<ImageGroup> groups;
  for (const auto& [key, rows] : images) {
    if (groups.empty() || groups.back().scene != key.first || groups.back().images.size() == size)
      groups.push_back({key.first, {}});
    groups.back().images.push_back(key.second);
  }
  return groups;
}

/// Camera poses that follow from the true poses of objects that stand still.
void add_cameras(std::int64_t scene, const std::map<std::int64_t, std::vector<BopRow>>& truth,
                 SceneCameras& cameras) {
  std::vector<std::vector<BopRow>> images;
  images.reserve(truth.size());
  for (const auto& [image, rows] : truth) images.push_back(rows);
  const StaticScene placed = static_scene(images);
  std::size_t k = 0;
  for (const auto& [image, rows] : truth) {
    if (const auto& camera = placed.world_camera[k++])
      cameras.emplace(std::pair(scene, image), *camera);
  }
}

SceneCameras cameras_of_truth(const std::string& path) {
  std::map<std::int64_t, std::map<std::int64_t, std::vector<BopRow>>> scenes;
  for (const BopRow& row : read_bop_rows(path)) scenes[row.scene][row.image].push_back(row);
  SceneCameras cameras;
  for (const auto& [scene, images] : scenes) add_cameras(scene, images, cameras);
  return cameras;
}

/// scene_camera.json where it has camera poses, else scene_gt.json.
SceneCameras cameras_of_dataset(const FuseViewsInput& input,
                                const std::vector<ImageGroup>& groups) {
  std::set<std::int64_t> numbers;
  for (const ImageGroup& group : groups) numbers.insert(group.scene);
  SceneCameras cameras;
  for (const std::int64_t number : numbers) {
    const DatasetScene scene = read_bop_scene(*input.dataset, input.split, number);
    bool has_pose = false;
    for (const auto& [image, pose] : scene.cameras) {
      if (pose) cameras.emplace(std::pair(number, image), *pose);
      has_pose = has_pose || pose;
    }
    if (has_pose) continue;
    std::map<std::int64_t, std::vector<BopRow>> truth;
    for (const auto& [image, instances] : scene.images) {
      for (const DatasetInstance& instance : instances)
        truth[image].push_back({number, image, instance.object, 1.0, instance.camera_object});
    }
    if (truth.empty()) scene.camera_poses();  // throws
    add_cameras(number, truth, cameras);
  }
  return cameras;
}

std::string camera_source(const FuseViewsInput& input) {
  if (input.cameras) return *input.cameras;
  return input.dataset ? *input.dataset : input.ground_truth.value_or("");
}

SymmetryGroups read_symmetries(const FuseViewsInput& input) {
  if (input.no_symmetries) return {};
  if (input.models_info) return read_symmetry_file(*input.models_info);
  if (!input.dataset) return {};
  const fs::path path = fs::path(*input.dataset) / "models" / "models_info.json";
  return fs::exists(path) ? read_symmetry_file(path) : SymmetryGroups{};
}

/// The only model of a file with tables [noise.NAME].
DetectorNoise read_noise_file(const std::string& path) {
  const TomlDocument document = TomlDocument::load(path);
  const TomlTable models = document.root().get_table("noise");
  const std::vector<std::string> names = models.keys();
  if (names.size() != 1)
    document.root().fail("noise", fmt::format("has {} models, expected one", names.size()));
  return read_detector_noise(models.get_table(names.front()));
}

}  // namespace

FuseViewsJob read_fuse_views_job(const FuseViewsInput& input) {
  const RowsByImage rows = read_rows_by_image(input.results);
  const std::vector<ImageGroup> groups =
      input.targets ? read_image_groups(*input.targets) : groups_of(rows, input.group_size);
  SceneCameras cameras;
  if (input.cameras) {
    cameras = read_scene_cameras(*input.cameras);
  } else if (input.dataset) {
    cameras = cameras_of_dataset(input, groups);
  } else {
    cameras = cameras_of_truth(*input.ground_truth);
  }
  const SymmetryGroups symmetries = read_symmetries(input);
  ViewClass known;
  if (input.noise) known.noise = read_noise_file(*input.noise);
  FuseViewsJob job;
  for (const ImageGroup& images : groups) {
    ViewGroup& group = job.groups.emplace_back(ViewGroup{images, {}});
    for (const std::int64_t image : images.images) {
      const auto camera = cameras.find({images.scene, image});
      if (camera == cameras.end()) {
        throw InvalidInput(
            fmt::format("{}: has no camera pose of image {} of scene {}, expected one",
                        camera_source(input), image, images.scene));
      }
      View& view = group.views.emplace_back(View{camera->second, {}});
      if (const auto found = rows.find({images.scene, image}); found != rows.end())
        view.observations = bop_observations(found->second, input.rows);
    }
  }
  for (const auto& [image, of_image] : rows) {
    for (const BopRow& row : of_image) {
      const auto group = symmetries.find(row.object);
      if (group != symmetries.end()) known.symmetries = group->second;
      job.classes.try_emplace(std::to_string(row.object), known);
      known.symmetries = SymmetryGroup();
    }
  }
  return job;
}

}  // namespace posemix
