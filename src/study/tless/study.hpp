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

/// Settings of `study tless`.
struct TlessStudySettings {
  std::filesystem::path data = {};         ///< the folder for read_tless
  std::vector<std::int64_t> scenes = {};   ///< empty: all
  double least_score = 0.5;                ///< least score of the detections
  std::uint64_t seed = 1;                  ///< seed of the synthetic odometry
  double odometry_rotation_sd_deg = 0.15;  ///< about each axis, per square root of a second
  double odometry_translation_sd_m = 2e-3;
  /// An estimate or detection farther than this from every true instance of its class belongs to
  /// none.
  double match_m = 0.05;
  SymmetryGroups symmetries = {};
  /// The points of the surface distance, by object; by default the corners of a cube of 10 cm.
  std::map<std::int64_t, std::array<Eigen::Vector3d, 8>> corners = {};
};

/// Reads the settings: `scenes` (numbers), `least_score`, `seed`, `odometry.rotation_sd_deg`,
/// `odometry.translation_sd_m`, `match_m`, `models_info` (path of BOP's models_info.json:
/// symmetries and boxes) and `symmetries` (path of a symmetry file, which takes precedence over
/// `models_info`; tless_symmetries by default).
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
/// by more than 20 deg from one frame to the next but by less to the nearest equivalent;
/// for objects with an axis of symmetry such turns are counted separately.
/// @throws InvalidInput when the data are missing, or have none of the scenes
Study make_tless_study(const TlessStudySettings& settings);

}  // namespace posemix
