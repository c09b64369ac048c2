// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/config/symmetries.hpp"
#include "posemix/io/bop.hpp"
#include "posemix/slam/association.hpp"
#include "posemix/slam/sequence.hpp"

/// T-LESS scenes from BOP result files, as recordings with several instances of a class and with
/// detections that do not name their instance.
namespace posemix {

/// A scene as a recording. The world is the camera of the first image.
///
/// `sequence` has one object per instance, in the order of class and appearance, named CLASS if
/// the scene has one instance of the class and CLASS.NUMBER (from zero) if it has several. It has
/// no detections (see `candidates`) and no odometry.
struct TlessScene {
  std::int64_t scene = 0;
  std::vector<std::int64_t> images;  ///< im_id, increasing; stamps are a tenth of it, in seconds
  Sequence sequence;                 ///< camera_truth, relative_truth and world_truth
  std::vector<std::string> classes;  ///< BOP object ids of the objects of `sequence`
  std::vector<std::vector<Candidate>> candidates;  ///< per image, in the file's order
};

/// Camera poses and true instances of one scene, in which a camera moves and objects stand still.
struct StaticScene {
  struct Instance {
    std::int64_t object = 0;                         ///< class
    SE3d world_object;                               ///< T_world_object, constant
    std::vector<std::optional<SE3d>> camera_object;  ///< T_camera_object per image
  };

  std::vector<std::optional<SE3d>> world_camera;  ///< per image; the first is the identity
  std::vector<Instance> instances;                ///< in the order of appearance
};

/// Camera poses and instances from true T_camera_object, per image. An image is placed such
/// that most of its objects coincide with known instances of their class, within 1 mm and 0.2 deg;
/// an image with several such places waits until others are placed. Images that remain have no
/// camera pose, and their objects belong to no instance.
StaticScene static_scene(std::span<const std::vector<BopRow>> images);

/// One scene from true and estimated rows (of any scenes); estimates below `least_score` are left
/// out.
/// @throws InvalidInput when there is no true row of the scene
TlessScene tless_scene(std::int64_t scene, std::span<const BopRow> truth,
                       std::span<const BopRow> estimates, double least_score);

/// The scenes of a data folder: bop_toolkit/gt-*tless*.csv with bop_toolkit/*megapose_tless*.csv.
/// @throws InvalidInput when the folder does not hold one of each
std::vector<TlessScene> read_tless(const std::filesystem::path& data, double least_score = 0.5);

/// Symmetries by object id as read off the residuals of a detector: configs/tless-symmetries.toml,
/// part of the library. Objects that are not in it have no known symmetries.
SymmetryGroups tless_symmetries();

}  // namespace posemix
