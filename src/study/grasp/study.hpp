// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "posemix/grasp/consensus.hpp"
#include "posemix/grasp/outcome.hpp"
#include "study/engine/study.hpp"

/// The success of grasps predicted from pose estimates and compared with recorded grasps.
namespace posemix {

/// An object that looks the same, or is grasped in the same way, after a rotation.
struct SymmetricObject {
  std::string dataset;
  std::int64_t object = 0;
  /// Its symmetries, by which errors are reduced; trivial where only their existence is known. The
  /// errors of a symmetric object are not used to learn those of an estimator.
  SymmetryGroup symmetry = {};
};

/// Settings of `study grasp`.
struct GraspStudySettings {
  std::uint64_t seed = 1;
  ErrorMixtureSettings errors = {};
  ConsensusSettings consensus = {};
  RegionFitSettings region = {};
  /// A region is fitted to an object and a gripper with this many successes and failures each.
  std::size_t least_outcomes = 1;
  std::size_t bootstrap_regions = 16;  ///< whose mean predicts
  std::size_t blocks = 5;              ///< of time, for objects with grasps in one scene only
  std::size_t bins = 10;               ///< of the reliability diagram and the calibration error
  /// Those that BOP flags in LM-O and YCB-V, and the can of YCB-V, which is grasped alike from all
  /// sides.
  std::vector<SymmetricObject> symmetric = default_symmetric();

  static std::vector<SymmetricObject> default_symmetric();
};

/// Reads settings; keys as in docs/studies.md, defaults as above.
/// @throws InvalidInput naming file, line and key
GraspStudySettings read_grasp_settings(const TomlTable& table);

/// The study: one work item per fold. Without `train`, split `scene` leaves one scene out (objects
/// with grasps in several scenes), split `block` a fraction of the time (objects with grasps in one
/// scene); with it, split `train` fits everything to `train` and predicts all of `data`. Report:
/// study.json (`method`, `split`, `object`, `gripper`, `estimator`, `region`, `grasps`, `brier`,
/// `log_loss`, `auc`, `calibration_error`, `accuracy`), predictions.csv, regions.csv, errors.csv,
/// reliability.svg.
/// @throws InvalidInput when no grasp can be predicted
Study make_grasp_study(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train,
                       const GraspStudySettings& settings);

}  // namespace posemix
