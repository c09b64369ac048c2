// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "study/grasp/data.hpp"

namespace posemix {

/// How often grasps of an object with a gripper succeed, and its region.
struct GraspRegion {
  std::size_t successes = 0;
  std::size_t failures = 0;
  std::optional<RegionFit> fit = {};          ///< where there are enough outcomes of both kinds
  std::vector<ToleranceRegion> regions = {};  ///< by bootstrap; what predicts
};

/// What a fold learns about grasps.
struct GraspKnowledge {
  std::map<std::pair<ObjectKey, std::size_t>, GraspRegion> regions;  ///< by object and gripper
  std::vector<GraspRegion> pooled;                                   ///< by gripper: all objects

  /// Region and name of what is used for a grasp: "own", "pooled" or "base_rate" (no region).
  std::pair<const std::vector<ToleranceRegion>*, const char*> region(const ObjectKey& object,
                                                                     std::size_t gripper) const;
  /// Success rate of the object, of the gripper where the object was never grasped.
  double base_rate(const ObjectKey& object, std::size_t gripper) const;
};

GraspKnowledge learn_regions(const GraspData& data, const GraspFold& fold,
                             const GraspStudySettings& settings, std::uint64_t stream);

}  // namespace posemix
