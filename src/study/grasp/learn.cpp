// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

constexpr int kBootstrapStarts = 2;
constexpr std::size_t kLeastErrors = 30;  ///< of a dataset's own model of an estimator

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

/// Errors of one estimator that say how it errs: of objects without symmetry, all where there are
/// too few. Empty dataset or estimator: of any.
std::vector<Vector6d> estimator_errors(const GraspData& data, const std::vector<bool>& learn,
                                       const std::string& dataset, const std::string& estimator) {
  std::vector<Vector6d> plain;
  std::vector<Vector6d> any;
  for (std::size_t i = 0; i < data.outcomes.trials.size(); ++i) {
    const GraspTrial& trial = data.outcomes.trials[i];
    if (!learn[i] || (!dataset.empty() && trial.dataset != dataset) ||
        (!estimator.empty() && trial.estimator != estimator)) {
      continue;
    }
    any.push_back(sight_error(trial.estimate, trial.truth));
    if (!data.symmetric[i]) plain.push_back(any.back());
  }
  return plain.size() >= kLeastErrors ? plain : any;
}

EstimatorErrors::Model learn_model(const GraspData& data, const std::vector<bool>& learn,
                                   const std::string& dataset, const std::string& estimator,
                                   const GraspStudySettings& settings, RandomStream& stream) {
  std::vector<Vector6d> errors = estimator_errors(data, learn, dataset, estimator);
  if (errors.size() < kLeastErrors) errors = estimator_errors(data, learn, "", estimator);
  if (errors.size() < kLeastErrors) errors = estimator_errors(data, learn, "", "");
  const ErrorMixtureFit fit = fit_error_mixture(errors, settings.errors, stream);
  const auto& mixture = fit.errors.mixture();
  return {dataset,
          estimator,
          errors.size(),
          fit.components,
          mixture.weight(mixture.size() - 1),
          {fit_error_gaussian(errors),
           fit_error_gaussian(trimmed_errors(errors, settings.errors.trim)), fit.errors}};
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

EstimatorErrors learn_errors(const GraspData& data, const GraspFold& fold,
                             const GraspStudySettings& settings, std::uint64_t stream) {
  RandomStream random(settings.seed, stream);
  EstimatorErrors learnt;
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  for (const GraspTrial& trial : data.outcomes.trials) {
    const auto [place, fresh] =
        known.try_emplace({trial.dataset, trial.estimator}, learnt.models.size());
    if (fresh) {
      learnt.models.push_back(
          learn_model(data, fold.learn, trial.dataset, trial.estimator, settings, random));
    }
    learnt.model_of.push_back(place->second);
  }
  return learnt;
}

}  // namespace posemix
