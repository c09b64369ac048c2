// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "posemix/slam/rig.hpp"

/// Names of images as detectors have searched them: `CAMERA`, by all of them, and
/// `CAMERA@DETECTOR`, by one; the camera is empty where there is one alone. The name of a camera is
/// taken for one also where it has an @, and so is the longest one before an @.
namespace posemix::internal {

struct SearchedImage {
  std::string camera;
  std::optional<std::string> detector = {};
};

inline bool is_camera(std::span<const BodyCamera> cameras, std::string_view name) {
  for (const BodyCamera& camera : cameras)
    if (camera.name == name) return true;
  return cameras.empty() && name.empty();
}

/// The image with a name.
/// @throws InvalidInput for a camera that there is not
inline SearchedImage searched_image(std::span<const BodyCamera> cameras, const std::string& name) {
  if (is_camera(cameras, name)) return {name};
  // Without any cameras every name is one.
  std::size_t at = cameras.empty() ? name.find('@') : name.rfind('@');
  while (!cameras.empty() && at != std::string::npos && !is_camera(cameras, name.substr(0, at)))
    at = at == 0 ? std::string::npos : name.rfind('@', at - 1);
  if (at != std::string::npos) return {name.substr(0, at), name.substr(at + 1)};
  index_of_camera(cameras, name.substr(0, name.find('@')));  // which throws, with any cameras
  return {name};
}

inline std::string name_of(const SearchedImage& image) {
  return image.detector ? image.camera + "@" + *image.detector : image.camera;
}

}  // namespace posemix::internal
