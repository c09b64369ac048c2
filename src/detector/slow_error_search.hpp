// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "detector/slow_error_parameters.hpp"

/// The greatest likelihood of the kinds of slow errors.
namespace posemix::internal {

/// A model with its parameters at the greatest likelihood.
struct FittedSlowModel {
  SlowParameters parameters;
  std::vector<double> x;
  std::vector<bool> is_free;  ///< parameters that are not at a bound
  double log_likelihood;
};

/// The tracks with what all models of them share.
struct SlowProblem {
  std::vector<SlowTrack> tracks;
  std::vector<PartGroups> groups;  ///< those that are tried
  SlowScales scales;
  std::size_t detections;

  std::vector<double> by_track(const SlowParameters& parameters, std::span<const double> x) const;
  double log_likelihood(const SlowParameters& parameters, std::span<const double> x) const;
};

/// The best maximum from starts with the slow error's lengths spread over what a track passes, of
/// models without an error in common.
FittedSlowModel best_of_starts(const SlowProblem& problem, const SlowParameters& parameters);

/// The model with errors in common, from the best one without.
FittedSlowModel with_common(const SlowProblem& problem, const FittedSlowModel& without);

/// Puts deviations that are not told from zero to their lower bound, and lengths that explain
/// nothing to their upper one.
void settle(const SlowProblem& problem, FittedSlowModel& model);

}  // namespace posemix::internal
