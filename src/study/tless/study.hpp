// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "posemix/config/symmetries.hpp"
#include "posemix/config/toml_table.hpp"
#include "study/engine/study.hpp"

/// Object SLAM with several equal and symmetric objects: T-LESS scenes.
namespace posemix {

/// What `study tless` runs on.
struct TlessStudySettings {
  std::filesystem::path data = {};         ///< as read_tless takes it
  std::vector<std::int64_t> scenes = {};   ///< empty: all
  double least_score = 0.5;                ///< of the detections
  std::uint64_t seed = 1;                  ///< of the synthetic odometry
  double odometry_rotation_sd_deg = 0.15;  ///< about each axis, per square root of a second
  double odometry_translation_sd_m = 2e-3;
  /// Farther than this from a true instance of its class, an estimate or a detection is of none.
  double match_m = 0.05;
  SymmetryGroups symmetries = {};
  /// Where the surface distance is measured, by object; the corners of a cube of 10 cm elsewhere.
  std::map<std::int64_t, std::array<Eigen::Vector3d, 8>> corners = {};
};

/// Reads the settings: `scenes` (numbers), `least_score`, `seed`, `odometry.rotation_sd_deg`,
/// `odometry.translation_sd_m`, `match_m`, `models_info` (path of BOP's models_info.json:
/// symmetries and boxes) and `symmetries` (path of a symmetry file; goes before those of
/// `models_info`; without either tless_symmetries).
/// @throws InvalidInput as TomlTable does
TlessStudySettings read_tless_settings(const TomlTable& table);

/// The study: every scene with the declared symmetries and without any. The filter is ObjectSlam
/// with its defaults; it gets detections that name a class, as many models of a class as the
/// largest number of its detections in one image and one more, and *synthetic* odometry: the true
/// motion of the camera with noise of the stated size. Errors are against the nearest equivalent of
/// the truth in both.
///
/// Report: study.json and tless.csv (one row per scene, symmetries and true instance), scenes.csv
/// (camera, false instances, flips), summary.csv. A flip: the world estimate of one instance turns
/// by more than 20 deg from one frame to the next while to the nearest equivalent it turns by less;
/// for objects with an axis of symmetry such turns are counted apart.
/// @throws InvalidInput when the data are not there, or have none of the scenes
Study make_tless_study(const TlessStudySettings& settings);

}  // namespace posemix
