// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/slow_error_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include <nlopt.hpp>

namespace posemix::internal {
namespace {

/// The gain of likelihood below which a deviation is not told from zero.
constexpr double kLeastGain = 0.5;

struct SlowObjective {
  const SlowProblem& problem;
  const SlowParameters& parameters;
};

double negative_log_likelihood(const std::vector<double>& x, std::vector<double>& /*gradient*/,
                               void* data) {
  const auto& objective = *static_cast<const SlowObjective*>(data);
  const double value = objective.problem.log_likelihood(objective.parameters, x);
  return std::isfinite(value) ? -value : 1e300;
}

/// One search from x to a maximum nearby; the likelihood there.
double search(const SlowProblem& problem, const SlowParameters& parameters, double step,
              std::vector<double>& x) {
  constexpr int kMostEvaluations = 1500;
  constexpr double kTolerance = 1e-3;
  nlopt::opt optimizer(nlopt::LN_BOBYQA, static_cast<unsigned>(x.size()));
  SlowObjective objective{problem, parameters};
  optimizer.set_min_objective(negative_log_likelihood, &objective);
  optimizer.set_lower_bounds(parameters.lower(problem.scales));
  optimizer.set_upper_bounds(parameters.upper(problem.scales));
  optimizer.set_initial_step(step);
  optimizer.set_xtol_abs(kTolerance);
  optimizer.set_ftol_abs(kTolerance);
  optimizer.set_maxeval(kMostEvaluations);
  double value = 0.0;
  try {
    optimizer.optimize(x, value);
  } catch (const std::runtime_error&) {  // rounding ended the search at the best point so far
  }
  return problem.log_likelihood(parameters, x);
}

/// Climbs from a start to the next maximum. A search can end early; another one shows whether it
/// did.
FittedSlowModel climbed(const SlowProblem& problem, const SlowParameters& parameters,
                        std::vector<double> x) {
  constexpr int kMostSearches = 6;
  constexpr double kStill = 0.05;
  const std::vector<double> lower = parameters.lower(problem.scales);
  const std::vector<double> upper = parameters.upper(problem.scales);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::clamp(x[i], lower[i], upper[i]);
  double likelihood = search(problem, parameters, 0.4, x);
  for (int round = 1; round < kMostSearches; ++round) {
    std::vector<double> next = x;
    const double now = search(problem, parameters, 0.15, next);
    const double gain = now - likelihood;
    if (gain > 0.0) {
      likelihood = now;
      x = std::move(next);
    }
    if (gain < kStill) break;
  }
  const std::size_t size = x.size();
  return {parameters, std::move(x), std::vector<bool>(size, true), likelihood};
}

void keep_better(FittedSlowModel model, std::optional<FittedSlowModel>& best) {
  if (!best || model.log_likelihood > best->log_likelihood) best = std::move(model);
}

}  // namespace

double SlowProblem::log_likelihood(const SlowParameters& parameters,
                                   std::span<const double> x) const {
  double sum = 0.0;
  for (const double each : by_track(parameters, x)) sum += each;
  return sum;
}

std::vector<double> SlowProblem::by_track(const SlowParameters& parameters,
                                          std::span<const double> x) const {
  const SlowVariances variances = parameters.variances(x, scales);
  std::vector<double> values;
  values.reserve(tracks.size());
  for (const SlowTrack& track : tracks)
    values.push_back(internal::log_likelihood(track, variances));
  return values;
}

void settle(const SlowProblem& problem, FittedSlowModel& model) {
  const SlowParameters& parameters = model.parameters;
  const std::vector<double> lower = parameters.lower(problem.scales);
  const std::vector<double> upper = parameters.upper(problem.scales);
  for (std::size_t i = 0; i < model.x.size(); ++i) {
    const bool is_length =
        parameters.has_slow() && i >= parameters.angle_at() && i < parameters.common_at();
    std::vector<double> moved = model.x;
    moved[i] = is_length ? upper[i] : lower[i];
    const double likelihood = problem.log_likelihood(parameters, moved);
    // One length less explains no less: it is infinite.
    if (!(likelihood > model.log_likelihood - (is_length ? 1e-3 : kLeastGain))) continue;
    model.x = std::move(moved);
    model.is_free[i] = false;
    model.log_likelihood = likelihood;
  }
}

FittedSlowModel best_of_starts(const SlowProblem& problem, const SlowParameters& parameters) {
  const std::vector<double> start = parameters.deviations(problem.scales, std::sqrt(0.5));
  const auto between = [](double least, double greatest, double share) {
    return (1.0 - share) * std::log(least) + share * std::log(greatest);
  };
  const SlowScales& scales = problem.scales;
  std::optional<FittedSlowModel> best;
  for (const auto& [angle, time] : {std::pair(0.35, 0.35), std::pair(0.75, 0.75),
                                    std::pair(0.35, 0.75), std::pair(0.75, 0.35)}) {
    if (angle != time && !(parameters.has_angle() && parameters.has_time())) continue;
    std::vector<double> x = start;
    if (parameters.has_angle())
      x.push_back(between(scales.least_angle_rad, scales.angle_rad, angle));
    if (parameters.has_time()) x.push_back(between(scales.least_time_s, scales.time_s, time));
    keep_better(climbed(problem, parameters, std::move(x)), best);
    if (!parameters.has_slow()) break;
  }
  return *std::move(best);
}

FittedSlowModel with_common(const SlowProblem& problem, const FittedSlowModel& without) {
  const SlowParameters parameters(without.parameters.decay(), true, without.parameters.groups());
  const std::vector<double> lower = parameters.lower(problem.scales);
  std::vector<double> none = without.x;
  none.insert(none.end(), lower.end() - 6, lower.end());
  const double likelihood = problem.log_likelihood(parameters, none);
  std::optional<FittedSlowModel> best =
      FittedSlowModel{parameters, none, std::vector<bool>(none.size(), true), likelihood};
  for (const double share : {0.4, 0.05}) {
    std::vector<double> x = without.x;
    for (const double sd : problem.scales.object_sd) x.push_back(std::log(share * sd));
    keep_better(climbed(problem, parameters, std::move(x)), best);
  }
  return *std::move(best);
}

}  // namespace posemix::internal
