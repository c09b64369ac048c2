// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posemix/lie/lie.hpp"

/// Recorded outcomes of grasps that were planned with estimated poses, as plain data.
namespace posemix {

/// One estimate of an object in one image, its truth, and what became of the grasps planned with
/// it.
struct GraspTrial {
  std::string dataset;
  std::string estimator;
  std::int64_t scene = 0;
  std::int64_t image = 0;   ///< increases with time within a scene
  std::int64_t object = 0;  ///< class of the object, by dataset
  double score = 0.0;       ///< the estimator's own confidence
  SE3d estimate;            ///< T_camera_object
  SE3d truth;               ///< T_camera_object
  /// Success of the grasp, one entry per gripper; empty where it was not tried.
  std::vector<std::optional<bool>> outcomes;
};

/// Trials of several estimators.
struct GraspOutcomes {
  std::vector<std::string> grippers;
  std::vector<GraspTrial> trials;
};

}  // namespace posemix
