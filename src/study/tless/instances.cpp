// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <deque>

#include "posemix/base/units.hpp"
#include "scene.hpp"

namespace posemix {
namespace {

/// Relative poses in one scene are constant up to the digits of the file.
constexpr double kSamePlaceM = 1e-3;
constexpr double kSameRotationRad = radians(0.2);

using Instance = StaticScene::Instance;

bool is_near(const SE3d& a, const SE3d& b) {
  const SE3d between = a.inverse() * b;
  return between.translation().norm() <= kSamePlaceM &&
         between.rotation().angle() <= kSameRotationRad;
}

bool is_at(const Instance& instance, const BopRow& row, const SE3d& world_camera) {
  return instance.object == row.object && is_near(instance.world_object, world_camera * row.pose);
}

std::size_t support(const std::vector<Instance>& instances, const std::vector<BopRow>& rows,
                    const SE3d& world_camera) {
  std::size_t count = 0;
  for (const BopRow& row : rows) {
    for (const Instance& instance : instances) {
      if (!is_at(instance, row, world_camera)) continue;
      ++count;
      break;
    }
  }
  return count;
}

/// The camera pose for which most objects of an image coincide with known instances; empty if there
/// is none, or if two different poses match equally many.
std::optional<SE3d> place_camera(const std::vector<Instance>& instances,
                                 const std::vector<BopRow>& rows) {
  std::optional<SE3d> best;
  std::size_t most = 0;
  bool is_clear = false;
  for (const BopRow& row : rows) {
    for (const Instance& instance : instances) {
      if (instance.object != row.object) continue;
      const SE3d camera = instance.world_object * row.pose.inverse();
      const std::size_t count = support(instances, rows, camera);
      if (count > most) {
        most = count;
        best = camera;
        is_clear = true;
      } else if (count == most && !is_near(*best * row.pose, camera * row.pose)) {
        is_clear = false;
      }
    }
  }
  return is_clear ? best : std::nullopt;
}

/// Assigns the objects of a placed image to their instances; the others begin new instances.
void add_image(StaticScene& scene, std::size_t image, const std::vector<BopRow>& rows,
               std::size_t images) {
  const SE3d& camera = *scene.world_camera[image];
  const std::size_t known = scene.instances.size();
  for (const BopRow& row : rows) {
    std::size_t at = 0;
    while (at < known && !is_at(scene.instances[at], row, camera)) ++at;
    if (at == known) {
      at = scene.instances.size();
      scene.instances.push_back(
          {row.object, camera * row.pose, std::vector<std::optional<SE3d>>(images)});
    }
    scene.instances[at].camera_object[image] = row.pose;
  }
}

}  // namespace

StaticScene static_scene(std::span<const std::vector<BopRow>> images) {
  StaticScene scene;
  scene.world_camera.resize(images.size());
  std::deque<std::size_t> waiting;
  for (std::size_t k = 0; k < images.size(); ++k) waiting.push_back(k);
  // A round over all images that places none ends the search.
  for (std::size_t idle = 0; !waiting.empty() && idle < waiting.size();) {
    const std::size_t k = waiting.front();
    waiting.pop_front();
    scene.world_camera[k] = k == 0 ? SE3d() : place_camera(scene.instances, images[k]);
    if (scene.world_camera[k]) {
      add_image(scene, k, images[k], images.size());
      idle = 0;
    } else {
      waiting.push_back(k);
      ++idle;
    }
  }
  return scene;
}

}  // namespace posemix
