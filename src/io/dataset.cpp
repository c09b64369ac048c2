// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/dataset.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

std::vector<SE3d> poses_in(const std::vector<DatasetInstance>& image, std::int64_t object) {
  std::vector<SE3d> poses;
  for (const DatasetInstance& instance : image)
    if (instance.object == object) poses.push_back(instance.camera_object);
  return poses;
}

}  // namespace

std::set<std::int64_t> DatasetScene::image_ids() const {
  std::set<std::int64_t> ids;
  for (const auto& [image, pose] : cameras) ids.insert(image);
  for (const auto& [image, instances] : images) ids.insert(image);
  return ids;
}

std::map<std::int64_t, std::size_t> DatasetScene::instance_counts() const {
  std::map<std::int64_t, std::size_t> most;
  for (const auto& [image, instances] : images) {
    std::map<std::int64_t, std::size_t> counts;
    for (const DatasetInstance& instance : instances) ++counts[instance.object];
    for (const auto& [object, count] : counts) most[object] = std::max(most[object], count);
  }
  return most;
}

std::map<std::int64_t, SE3d> DatasetScene::poses_of(std::int64_t object,
                                                    std::optional<std::size_t> instance) const {
  std::map<std::int64_t, SE3d> result;
  std::size_t count = 0;
  for (const auto& [image, instances] : images) {
    const std::vector<SE3d> poses = poses_in(instances, object);
    if (poses.empty()) continue;
    if (!instance && poses.size() > 1) {
      throw InvalidInput(
          fmt::format("{}: image {}: got {} instances of object {}, expected one, "
                      "or a key 'instance' (0 to {})",
                      name, image, poses.size(), object, poses.size() - 1));
    }
    if (count == 0) count = poses.size();
    const std::size_t index = instance.value_or(0);
    if (poses.size() != count || index >= count) {
      throw InvalidInput(fmt::format(
          "{}: image {}: got {} instances of object {}, expected {}for instance {}", name, image,
          poses.size(), object,
          poses.size() != count ? fmt::format("{} as in other images ", count) : "more ", index));
    }
    result.emplace(image, poses[index]);
  }
  if (!result.empty()) return result;
  throw InvalidInput(
      fmt::format("{}: got no annotation of object {}, expected at least one", name, object));
}

std::map<std::int64_t, SE3d> DatasetScene::camera_poses() const {
  std::map<std::int64_t, SE3d> poses;
  for (const auto& [image, pose] : cameras)
    if (pose) poses.emplace(image, *pose);
  if (!poses.empty()) return poses;
  throw InvalidInput(
      fmt::format("{}: got no camera pose, expected some: the dataset does not say "
                  "how the camera moved",
                  name));
}

}  // namespace posemix
