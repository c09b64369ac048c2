// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/grasp/estimator_errors.hpp"

#include <map>
#include <utility>

namespace posemix {
namespace {

constexpr std::size_t kLeastErrors = 30;  ///< of a dataset's own model of an estimator

/// The errors of one estimator with objects without symmetry, or with all objects where there are
/// too few. An empty dataset or estimator stands for any.
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
