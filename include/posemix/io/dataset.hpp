// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/lie/lie.hpp"

/// Annotated scenes in the folders of a dataset: BOP (millimetres in its files) or YCB-Video
/// (metres).
namespace posemix {

/// An annotated object in an image.
struct DatasetInstance {
  std::int64_t object = 0;
  SE3d camera_object;  ///< T_camera_object, metres
};

/// Annotated objects by image id; those of one image are in the order of the file.
using DatasetImages = std::map<std::int64_t, std::vector<DatasetInstance>>;
/// T_world_camera by image id; empty if it is not known.
using DatasetCameras = std::map<std::int64_t, std::optional<SE3d>>;

/// One scene.
struct DatasetScene {
  std::string name;  ///< name of the scene's folder, for messages
  DatasetCameras cameras;
  DatasetImages images;

  /// The ids of all images.
  std::set<std::int64_t> image_ids() const;
  /// The largest number of annotations of an object in one image, by object id.
  std::map<std::int64_t, std::size_t> instance_counts() const;
  /// T_camera_object by image id. `instance` counts from zero in the order of the file.
  /// @throws InvalidInput when the object is in no image; without `instance` when an image has
  /// several instances; with `instance` when there is no such instance, or images have different
  /// numbers of them
  std::map<std::int64_t, SE3d> poses_of(std::int64_t object,
                                        std::optional<std::size_t> instance = {}) const;
  /// T_world_camera by image id.
  /// @throws InvalidInput when no image has one
  std::map<std::int64_t, SE3d> camera_poses() const;
};

/// Reads `scene_gt.json`: per image id an array of `{obj_id, cam_R_m2c, cam_t_m2c}`, R row by row,
/// t in millimetres. Other keys are ignored.
/// @throws InvalidInput naming file, image and key
DatasetImages parse_bop_scene_gt(std::string_view text, const std::string& name);

/// Reads `scene_camera.json`: per image id an object with `cam_R_w2c` and `cam_t_w2c`
/// (millimetres), T_camera_world, or with neither of them.
/// @throws InvalidInput naming file, image and key
DatasetCameras parse_bop_scene_camera(std::string_view text, const std::string& name);

/// The folder `<dataset>/<split>/<scene, six digits>`.
std::filesystem::path bop_scene_folder(const std::filesystem::path& dataset,
                                       const std::string& split, std::int64_t scene);

/// Reads a scene of a BOP dataset; `scene_gt.json` or `scene_camera.json` may be missing, but not
/// both.
/// @throws InvalidInput naming the folder or file
DatasetScene read_bop_scene(const std::filesystem::path& dataset, const std::string& split,
                            std::int64_t scene);

/// Reads the scene of a YCB-Video sequence, `<dataset>/data/<sequence>/NNNNNN-meta.mat`:
/// `cls_indexes`, `poses` (3x4xn, T_camera_object) and, if present, `rotation_translation_matrix`
/// (3x4, T_camera_world).
/// @throws InvalidInput naming file, variable and what was expected
DatasetScene read_ycb_video_scene(const std::filesystem::path& dataset,
                                  const std::string& sequence);

/// The names of the objects of a YCB-Video dataset, from `image_sets/classes.txt`; the first is
/// that of object 1. Empty if there is no such file.
std::vector<std::string> read_ycb_video_names(const std::filesystem::path& dataset);

}  // namespace posemix
