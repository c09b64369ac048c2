// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/knowledge.hpp"

#include <algorithm>

namespace posemix {
namespace {

constexpr int kBootstrapStarts = 2;

/// Outcomes of one object and gripper, or of one gripper, with the detection of each.
struct GroupedOutcomes {
  std::vector<ErrorOutcome> outcomes;
  std::vector<std::size_t> detections;
};

GraspRegion learn_region(const GroupedOutcomes& known, const GraspStudySettings& settings,
                         RandomStream& stream) {
  GraspRegion region;
  for (const ErrorOutcome& o : known.outcomes) ++(o.success ? region.successes : region.failures);
  if (std::min(region.successes, region.failures) < settings.least_outcomes) return region;
  region.fit = fit_tolerance_region(known.outcomes, settings.region, stream);
  RegionFitSettings again = settings.region;
  again.starts = std::min(again.starts, kBootstrapStarts);
  region.regions = bootstrap_regions(known.outcomes, known.detections, settings.bootstrap_regions,
                                     again, stream);
  return region;
}

double smoothed_rate(const GraspRegion& region) {
  return (static_cast<double>(region.successes) + 1.0) /
         (static_cast<double>(region.successes + region.failures) + 2.0);
}

}  // namespace

std::pair<const std::vector<ToleranceRegion>*, const char*> GraspKnowledge::region(
    const ObjectKey& object, std::size_t gripper) const {
  const auto own = regions.find({object, gripper});
  const bool grasped = own != regions.end();
  const GraspRegion& region = grasped ? own->second : pooled[gripper];
  if (region.regions.empty()) return {nullptr, "base_rate"};
  return {&region.regions, grasped ? "own" : "pooled"};
}

double GraspKnowledge::base_rate(const ObjectKey& object, std::size_t gripper) const {
  const auto known = regions.find({object, gripper});
  return smoothed_rate(known == regions.end() ? pooled[gripper] : known->second);
}

GraspKnowledge learn_regions(const GraspData& data, const GraspFold& fold,
                             const GraspStudySettings& settings, std::uint64_t stream) {
  std::map<std::pair<ObjectKey, std::size_t>, GroupedOutcomes> own;
  std::vector<GroupedOutcomes> pooled(data.outcomes.grippers.size());
  for (const GraspCase& grasp : data.cases(fold.learn)) {
    for (GroupedOutcomes* group :
         {&own[{data.object(grasp.trial), grasp.gripper}], &pooled[grasp.gripper]}) {
      group->outcomes.push_back({data.errors[grasp.trial], grasp.success});
      group->detections.push_back(data.detections[grasp.trial]);
    }
  }
  RandomStream random(settings.seed, stream);
  GraspKnowledge knowledge;
  for (const auto& [key, known] : own) {
    knowledge.regions[key] = learn_region(known, settings, random);
  }
  for (const GroupedOutcomes& known : pooled) {
    knowledge.pooled.push_back(learn_region(known, settings, random));
  }
  return knowledge;
}

}  // namespace posemix
