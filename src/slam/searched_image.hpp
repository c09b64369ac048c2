// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/object_model.hpp"
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

/// The image with a name; without any cameras every name is one of a camera.
inline std::optional<SearchedImage> find_searched_image(std::span<const BodyCamera> cameras,
                                                        const std::string& name) {
  if (is_camera(cameras, name)) return SearchedImage{name};
  std::size_t at = cameras.empty() ? name.find('@') : name.rfind('@');
  while (!cameras.empty() && at != std::string::npos && !is_camera(cameras, name.substr(0, at)))
    at = at == 0 ? std::string::npos : name.rfind('@', at - 1);
  if (at != std::string::npos) return SearchedImage{name.substr(0, at), name.substr(at + 1)};
  return cameras.empty() ? std::optional(SearchedImage{name}) : std::nullopt;
}

/// @throws InvalidInput for a camera that there is not
inline SearchedImage searched_image(std::span<const BodyCamera> cameras, const std::string& name) {
  const auto image = find_searched_image(cameras, name);
  if (!image) index_of_camera(cameras, name.substr(0, name.find('@')));  // which throws
  return image.value();
}

/// Names of all detectors; none where an object takes detections of any, or there are no objects.
inline std::optional<std::set<std::string>> names_of_detectors(
    std::span<const ObjectModel> models) {
  std::set<std::string> names;
  for (const ObjectModel& model : models) {
    if (model.detectors.empty()) return std::nullopt;
    for (const auto& [name, noise] : model.detectors) names.insert(name);
  }
  return models.empty() ? std::nullopt : std::optional(names);
}

/// @throws InvalidInput for a detector that no object has
inline void require_known_detector(const SearchedImage& image,
                                   const std::optional<std::set<std::string>>& names) {
  const std::string name = image.detector.value_or("");
  if (name.empty() || !names || names->contains(name)) return;
  throw InvalidInput(fmt::format("got an image of detector '{}', expected one of: {}", name,
                                 fmt::join(*names, ", ")));
}

inline std::string name_of(const SearchedImage& image) {
  return image.detector ? image.camera + "@" + *image.detector : image.camera;
}

}  // namespace posemix::internal
