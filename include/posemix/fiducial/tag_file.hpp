// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "posemix/fiducial/camera_file.hpp"

namespace posemix {

/// What is known of the tags before they are seen.
struct TagMap {
  std::map<std::int64_t, double> size_m = {};  ///< edge by id
  std::optional<double> default_size_m = {};   ///< of the other tags
  std::set<std::int64_t> ignored = {};         ///< ids
  /// T_map_tag by id, of tags on static bodies whose poses are stated with their noise.
  std::map<std::int64_t, StatedPose> priors = {};

  /// The size of a tag; nothing where it is unknown.
  std::optional<double> size_of(std::int64_t tag) const;
};

/// The tags of TagSLAM's tagslam.yaml: sizes, ignored ids, and poses with `position_noise` and
/// `rotation_noise` (standard deviations along the axes of the tag), composed with the pose of
/// their body. Tags on moving bodies and poses without noise are no priors.
/// @throws InvalidInput `name:line: key: got ..., expected ...`, and in a build without yaml-cpp
TagMap parse_tag_map(std::string_view text, const std::string& name);
TagMap read_tag_map(const std::filesystem::path& path);

}  // namespace posemix
