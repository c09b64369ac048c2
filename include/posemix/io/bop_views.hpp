// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/io/bop.hpp"

/// BOP result files of images that are looked at together: observations, groups of images, and
/// camera poses.
namespace posemix {

/// What the rows of one object in one image are.
enum class BopRowUse {
  mixtures,  ///< rows at one place are one observation, other rows other instances
  rows,      ///< every row is an observation
  best       ///< only the row of the highest score is one
};

/// The words of BopRowUse in options and settings.
template <>
inline constexpr WordTable<BopRowUse, 3> words<BopRowUse>{{
    {"mixtures", BopRowUse::mixtures},
    {"rows", BopRowUse::rows},
    {"best", BopRowUse::best},
}};

struct BopObservationSettings {
  BopRowUse use = BopRowUse::mixtures;
  /// Rows with lower scores are left out.
  double least_score = -std::numeric_limits<double>::infinity();
  /// Rows of one object within this distance of the row of the highest score are of one place [m].
  double same_place_m = 0.02;
};

/// The observations of one image: `class_id` is the object's number, `score` the highest score.
/// Weights of the rows at one place are their scores over the sum of these; where a score is
/// negative or all are zero, the weights are equal. In the order of object and falling score.
std::vector<Observation> bop_observations(std::span<const BopRow> rows,
                                          const BopObservationSettings& settings = {});

/// Images of one scene that are looked at together.
struct ImageGroup {
  std::int64_t scene = 0;
  std::vector<std::int64_t> images = {};

  bool operator==(const ImageGroup&) const = default;
};

/// Reads the multi-view targets of BOP: an array of {scene_id, im_id}, with an array of image ids,
/// each a number or [camera, number]; the camera's name is not used. Other keys are ignored.
/// @throws InvalidInput naming file and key, also for an image twice in a group
std::vector<ImageGroup> parse_image_groups(std::string_view text, const std::string& name);
std::vector<ImageGroup> read_image_groups(const std::filesystem::path& path);

/// T_world_camera by scene and image.
using SceneCameras = std::map<std::pair<std::int64_t, std::int64_t>, SE3d>;

/// Reads camera poses from CSV: a head line `scene_id,im_id,tx,ty,tz,qx,qy,qz,qw`, then
/// T_world_camera of every image, metres and a unit quaternion. Lines that begin with '#' are
/// comments.
/// @throws InvalidInput `name:line: got ..., expected ...`, also for an image again
SceneCameras parse_scene_cameras(std::string_view text, const std::string& name);
SceneCameras read_scene_cameras(const std::filesystem::path& path);

/// The text of a BOP result file; the time of all rows is `time_s`, -1 where it is not known.
std::string format_bop_rows(std::span<const BopRow> rows, double time_s = -1.0);

}  // namespace posemix
