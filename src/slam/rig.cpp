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

ConcentratedGaussian<SE3d> BodyCamera::prior() const {
  if (is_exact())
    throw InvalidInput(fmt::format("camera '{}' is exact, expected one with a covariance", name));
  return {body_camera, body_camera.adjoint_congruence(*covariance)};
}

std::optional<std::size_t> index_of_camera(std::span<const BodyCamera> cameras,
                                           std::string_view name) {
  if (cameras.empty()) return std::nullopt;
  const auto found = std::find_if(cameras.begin(), cameras.end(),
                                  [&](const BodyCamera& camera) { return camera.name == name; });
  if (found != cameras.end()) return static_cast<std::size_t>(found - cameras.begin());
  std::vector<std::string_view> names;
  for (const BodyCamera& camera : cameras) names.push_back(camera.name);
  throw InvalidInput(
      fmt::format("there is no camera '{}', expected one of: {}", name, fmt::join(names, ", ")));
}

SE3d pose_on_body(std::span<const BodyCamera> cameras, std::string_view name) {
  const auto index = index_of_camera(cameras, name);
  return index ? cameras[*index].body_camera : SE3d();
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
    if (!camera.is_exact())
      checked_covariance(*camera.covariance, 6,
                         fmt::format("the covariance of camera '{}'", camera.name));
  }
}

}  // namespace posemix
