// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "posemix/config/symmetries.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/io/bop_models.hpp"
#include "posemix/slam/fuse_views.hpp"
#include "study/engine/study.hpp"

/// Poses fused from several views against those of single views: T-LESS and YCB-V.
namespace posemix {

/// What is known of the objects of a dataset.
struct FuseViewsObjects {
  SymmetryGroups symmetries = {};
  std::map<std::int64_t, ObjectBox> boxes = {};  ///< by default a cube of 10 cm
};

/// Settings of `study fuse-views`.
struct FuseViewsStudySettings {
  std::filesystem::path data = {};
  std::vector<std::string> datasets = {"tless", "ycbv"};
  std::vector<std::int64_t> scenes = {};  ///< empty: all
  std::size_t views = 4;                  ///< of a group
  std::uint64_t seed = 1;                 ///< of the random groups
  double least_score = 0.0;
  /// A pose farther than this from every true instance of its class belongs to none [m].
  double match_m = 0.05;
  std::map<std::string, FuseViewsObjects> objects = {};  ///< by dataset
  FuseViewsSettings fusion = {};
};

/// Reads the settings: `datasets`, `scenes`, `views`, `seed`, `least_score`, `match_m`,
/// `models_info.DATASET` and `symmetries.DATASET` (paths; by default the symmetries of T-LESS are
/// tless_symmetries and YCB-V has none), and `fusion` with the fields of FuseViewsSettings.
/// @throws InvalidInput as TomlTable does
FuseViewsStudySettings read_fuse_views_settings(const TomlTable& table);

/// The study: the detections of every scene in groups of views, chosen at random and in the order
/// of the images, fused by fuse_views with the best rows, all rows and mixtures of rows as
/// observations, with declared symmetries and with none. Camera poses follow from the true poses
/// of the objects. Errors are against the nearest equivalent of the truth in all of them.
///
/// Report: study.json and fuse-views.csv (one row per scene and kind of input), summary.csv, and
/// noise-DATASET.toml with a learned noise.
/// @throws InvalidInput when the data are missing, or have none of the scenes
Study make_fuse_views_study(const FuseViewsStudySettings& settings);

}  // namespace posemix
