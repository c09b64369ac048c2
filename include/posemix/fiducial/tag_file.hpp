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
#include <vector>

#include "posemix/fiducial/camera_file.hpp"

namespace posemix {

/// A tag that carries the id of another one for some time, as when one is moved.
struct TagRemap {
  std::int64_t id = 0;  ///< as it is seen
  std::int64_t stands_for = 0;
  double from_s = 0.0;  ///< first stamp
  double to_s = 0.0;    ///< last stamp
};

/// What is known of the tags before they are seen.
struct TagMap {
  std::map<std::int64_t, double> size_m = {};  ///< edge by id
  std::optional<double> default_size_m = {};   ///< of the other tags
  std::set<std::int64_t> ignored = {};         ///< ids
  /// T_map_tag by id, of tags on static bodies whose poses are stated with their noise.
  std::map<std::int64_t, StatedPose> priors = {};

  std::vector<TagRemap> remaps = {};
  /// T_rig_odom: where the frame whose motion the odometry states is on the rig.
  std::optional<SE3d> rig_odometry = {};

  /// The tag that is meant by an id at a time.
  std::int64_t tag_at(std::int64_t id, double stamp_s) const;
  /// The size of a tag; nothing where it is unknown.
  std::optional<double> size_of(std::int64_t tag) const;
};

/// The tags of TagSLAM's tagslam.yaml: sizes, ignored ids, and poses with `position_noise` and
/// `rotation_noise` (standard deviations along the axes of the tag), composed with the pose of
/// their body; `override_tag_position_noise` and `override_tag_rotation_noise` of the body take the
/// place of those of its tags. Tags on moving bodies and poses without noise are no priors.
/// `T_body_odom` of a moving body, and `tag_id_remap`, are read too.
/// @throws InvalidInput `name:line: key: got ..., expected ...`, and in a build without yaml-cpp
TagMap parse_tag_map(std::string_view text, const std::string& name);
TagMap read_tag_map(const std::filesystem::path& path);

}  // namespace posemix
