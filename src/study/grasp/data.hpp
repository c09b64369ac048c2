// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/grasp/study.hpp"

/// The trials of a study of grasps, and its folds.
namespace posemix {

/// One grasp.
struct GraspCase {
  std::size_t trial;
  std::size_t gripper;
  bool success;
};

/// Trials to learn from, and grasps to predict.
struct GraspFold {
  std::string split;
  std::string name;
  std::vector<bool> learn;  ///< by trial
  std::vector<GraspCase> test;
};

/// Dataset and object.
using ObjectKey = std::pair<std::string, std::int64_t>;

/// All trials, those to learn from after those to predict, and what follows from them alone.
struct GraspData {
  GraspOutcomes outcomes;
  std::size_t predicted = 0;              ///< number of trials whose grasps are predicted
  std::vector<SymmetryGroup> symmetries;  ///< by trial
  std::vector<bool> symmetric;            ///< by trial: whether the object is known as such
  std::vector<SE3d> errors;             ///< by trial, T_truth^-1 T_estimate reduced by the symmetry
  std::vector<std::size_t> detections;  ///< by trial: an object in an image
  std::vector<std::vector<std::size_t>> members;  ///< by detection: its trials
  std::vector<GraspFold> folds;

  ObjectKey object(std::size_t trial) const {
    return {outcomes.trials[trial].dataset, outcomes.trials[trial].object};
  }
  std::vector<GraspCase> cases(const std::vector<bool>& chosen) const;
};

/// @throws InvalidInput when no grasp can be predicted
GraspData grasp_data(const GraspOutcomes& data, const std::optional<GraspOutcomes>& train,
                     const GraspStudySettings& settings);

}  // namespace posemix
