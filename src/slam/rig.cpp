// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/rig.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"

namespace posemix {

SE3d pose_on_body(std::span<const BodyCamera> cameras, std::string_view name) {
  if (cameras.empty()) return {};
  const auto found = std::find_if(cameras.begin(), cameras.end(),
                                  [&](const BodyCamera& camera) { return camera.name == name; });
  if (found != cameras.end()) return found->body_camera;
  std::vector<std::string_view> names;
  for (const BodyCamera& camera : cameras) names.push_back(camera.name);
  throw InvalidInput(
      fmt::format("there is no camera '{}', expected one of: {}", name, fmt::join(names, ", ")));
}

void require_valid(std::span<const BodyCamera> cameras) {
  std::set<std::string_view> names;
  for (const BodyCamera& camera : cameras) {
    if (!names.insert(camera.name).second)
      throw InvalidInput(fmt::format("two cameras have the name '{}'", camera.name));
    if (!camera.body_camera.matrix().allFinite()) {
      throw InvalidInput(
          fmt::format("the pose of camera '{}' holds a value that is not finite", camera.name));
    }
  }
}

}  // namespace posemix
