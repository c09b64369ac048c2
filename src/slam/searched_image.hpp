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
/// taken for one also where it has an @.
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
  const std::size_t at = name.rfind('@');
  if (at == std::string::npos || is_camera(cameras, name)) {
    index_of_camera(cameras, name);
    return {name};
  }
  SearchedImage image{name.substr(0, at), name.substr(at + 1)};
  index_of_camera(cameras, image.camera);
  return image;
}

inline std::string name_of(const SearchedImage& image) {
  return image.detector ? image.camera + "@" + *image.detector : image.camera;
}

}  // namespace posemix::internal
