// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/slow_error_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "detector/slow_error_jackknife.hpp"
#include "detector/slow_error_search.hpp"
#include "posemix/base/statistics.hpp"

namespace posemix {
namespace {

using namespace internal;

double bic_of(double log_likelihood, std::size_t parameters, std::size_t detections) {
  return static_cast<double>(parameters) * std::log(static_cast<double>(detections)) -
         2.0 * log_likelihood;
}

SlowErrorModel summary_of(const FittedSlowModel& model, std::size_t detections) {
  const auto free = std::count(model.is_free.begin(), model.is_free.end(), true);
  return {.decay = model.parameters.decay(),
          .common = model.parameters.has_common(),
          .log_likelihood = model.log_likelihood,
          .parameters = static_cast<std::size_t>(free),
          .bic = bic_of(model.log_likelihood, static_cast<std::size_t>(free), detections)};
}

/// The log-likelihood by recording.
std::vector<double> by_recording(const SlowProblem& problem, const FittedSlowModel& model) {
  const std::vector<double> by_track = problem.by_track(model.parameters, model.x);
  std::map<std::size_t, double> sums;
  for (std::size_t i = 0; i < by_track.size(); ++i)
    sums[problem.tracks[i].recording] += by_track[i];
  std::vector<double> values;
  values.reserve(sums.size());
  for (const auto& [recording, sum] : sums) values.push_back(sum);
  return values;
}

/// The gain of one model over another, from their log-likelihoods by recording.
struct SlowGain {
  double gain;
  double standard_error;  ///< from the gains by recording, NaN with too few

  bool is_significant() const { return !(gain < 2.0 * standard_error); }
};

SlowGain gain_over(const std::vector<double>& other, const std::vector<double>& model,
                   bool has_recordings) {
  std::vector<double> gains;
  gains.reserve(model.size());
  for (std::size_t r = 0; r < model.size(); ++r) gains.push_back(model[r] - other[r]);
  const auto [mean, error] = mean_with_error(gains);
  const auto count = static_cast<double>(gains.size());
  return {count * mean, has_recordings ? count * error : std::numeric_limits<double>::quiet_NaN()};
}

/// Fills in the models of the fit and chooses one.
void choose(const SlowProblem& problem, const std::vector<FittedSlowModel>& models,
            SlowErrorFit& fit) {
  constexpr double kRounding = 0.1;  ///< models that are the same differ by it
  std::vector<std::vector<double>> likelihoods;
  for (const FittedSlowModel& model : models) {
    fit.models.push_back(summary_of(model, problem.detections));
    likelihoods.push_back(by_recording(problem, model));
  }
  std::size_t best = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (fit.models[i].bic < fit.models[best].bic - kRounding) best = i;
  }
  // Another model explains more with no more parameters.
  const auto is_dominated = [&](const SlowErrorModel& model) {
    return std::any_of(fit.models.begin(), fit.models.end(), [&](const SlowErrorModel& other) {
      return other.parameters <= model.parameters &&
             other.log_likelihood > model.log_likelihood + kRounding;
    });
  };
  fit.chosen = best;
  for (std::size_t i = 0; i < models.size(); ++i) {
    SlowErrorModel& model = fit.models[i];
    const SlowGain gain = gain_over(likelihoods[i], likelihoods[best], fit.is_jackknife);
    model.below_best = gain.gain;
    model.standard_error = gain.standard_error;
    if (!gain.is_significant() && !is_dominated(model) &&
        model.parameters < fit.models[fit.chosen].parameters)
      fit.chosen = i;
  }
  for (std::size_t i = 0; i < models.size(); ++i) {
    const SlowErrorModel& chosen = fit.models[fit.chosen];
    if (chosen.decay == SlowErrorDecay::time && fit.models[i].decay == SlowErrorDecay::angle &&
        fit.models[i].common == chosen.common &&
        !gain_over(likelihoods[i], likelihoods[fit.chosen], fit.is_jackknife).is_significant())
      fit.chosen = i;
  }
}

/// The model without errors in common of the groups of axes with the least BIC.
FittedSlowModel best_of_groups(const SlowProblem& problem, SlowErrorDecay decay) {
  std::optional<FittedSlowModel> best;
  const auto bic = [&](const FittedSlowModel& model) {
    return bic_of(model.log_likelihood, model.x.size(), problem.detections);
  };
  for (const PartGroups& groups : problem.groups) {
    const SlowParameters parameters(decay, false, groups);
    FittedSlowModel model = best_of_starts(problem, parameters);
    if (!best || bic(model) < bic(*best)) best = std::move(model);
    if (!parameters.has_slow()) break;  // the groups differ in the slow part alone
  }
  return *std::move(best);
}

/// All models that the tracks allow.
std::vector<FittedSlowModel> fitted_models(const SlowProblem& problem) {
  constexpr std::size_t kLeastTracksForCommon = 3;
  const bool has_stamps =
      std::all_of(problem.tracks.begin(), problem.tracks.end(), [](const SlowTrack& track) {
        return std::all_of(track.rows.begin(), track.rows.end(),
                           [](const SlowRow& row) { return std::isfinite(row.time_s); });
      });
  std::vector<FittedSlowModel> models;
  for (const auto& [word, decay] : words<SlowErrorDecay>) {
    const bool has_time = decay == SlowErrorDecay::time || decay == SlowErrorDecay::angle_and_time;
    if (has_time && !has_stamps) continue;
    models.push_back(best_of_groups(problem, decay));
    if (problem.tracks.size() < kLeastTracksForCommon) continue;
    models.push_back(with_common(problem, models.back()));
  }
  for (FittedSlowModel& model : models) {
    settle(problem, model);
    const auto by_track = [&](std::span<const double> x) {
      return problem.by_track(model.parameters, x);
    };
    // What a search leaves undone depends on rounding; this does not.
    model.x = polished(by_track, model.x, model.is_free);
    model.log_likelihood = problem.log_likelihood(model.parameters, model.x);
  }
  return models;
}

/// A covariance with these deviations and the correlation coefficients of the component.
Matrix6d covariance_of(const Vector6d& sd, const NoiseComponent& inlier) {
  const Vector6d by = sd.cwiseQuotient(inlier.covariance.diagonal().cwiseSqrt());
  return by.asDiagonal() * inlier.covariance * by.asDiagonal();
}

/// Fills in the parameters and their standard errors, those of the logs in `errors`.
void add_parameters(const FittedSlowModel& model, const SlowScales& scales,
                    const Eigen::VectorXd& errors, const NoiseComponent& inlier,
                    SlowErrorFit& fit) {
  const SlowParameters& parameters = model.parameters;
  const SlowVariances variances = parameters.variances(model.x, scales);
  const auto error_at = [&](std::size_t i) { return errors[static_cast<Eigen::Index>(i)]; };
  fit.white_sd = variances.white.cwiseSqrt();
  fit.slow_sd = variances.slow.cwiseSqrt();
  fit.common_sd = variances.common.cwiseSqrt();
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const PartGroups& groups = parameters.groups();
    fit.white_sd_error[at] = fit.white_sd[at] * error_at(groups.white.group[axis]);
    if (parameters.has_slow())
      fit.slow_sd_error[at] =
          fit.slow_sd[at] * error_at(parameters.slow_at() + groups.slow.group[axis]);
    if (parameters.has_common())
      fit.common_sd_error[at] = fit.common_sd[at] * error_at(parameters.common_at() + axis);
  }
  fit.white = covariance_of(fit.white_sd, inlier);
  if (parameters.has_slow()) {
    fit.slow = SlowError{.covariance = covariance_of(fit.slow_sd, inlier),
                         .correlation_time_s = variances.time_s,
                         .correlation_angle_rad = variances.angle_rad};
  }
  if (parameters.has_angle())
    fit.correlation_angle_error_rad = variances.angle_rad * error_at(parameters.angle_at());
  if (parameters.has_time())
    fit.correlation_time_error_s = variances.time_s * error_at(parameters.time_at());
  if (variances.common.maxCoeff() > 0.0) fit.common = Matrix6d(variances.common.asDiagonal());
}

/// Standard errors of the logs of all parameters, NaN for those at a bound.
Eigen::VectorXd errors_of(const SlowProblem& problem, const FittedSlowModel& model,
                          bool is_jackknife) {
  std::vector<std::size_t> recordings;
  recordings.reserve(problem.tracks.size());
  for (const SlowTrack& track : problem.tracks) recordings.push_back(track.recording);
  const auto by_track = [&](std::span<const double> x) {
    return problem.by_track(model.parameters, x);
  };
  return log_parameter_errors(by_track, recordings, model.x, model.is_free, is_jackknife);
}

}  // namespace

SlowErrorFit fit_slow_error(std::span<const NoiseTrack> tracks, const NoiseComponent& inlier) {
  constexpr std::size_t kLeastDetections = 50;
  constexpr std::size_t kRecordingsForJackknife = 5;
  SlowProblem problem{
      .tracks = slow_tracks(tracks, inlier), .groups = {}, .scales = {}, .detections = 0};
  std::set<std::size_t> recordings;
  for (const SlowTrack& track : problem.tracks) {
    problem.detections += track.rows.size();
    recordings.insert(track.recording);
  }
  SlowErrorFit fit{.white = inlier.covariance,
                   .white_sd = inlier.covariance.diagonal().cwiseSqrt(),
                   .detections = problem.detections,
                   .recordings = recordings.size(),
                   .is_jackknife = recordings.size() >= kRecordingsForJackknife};
  if (problem.detections < kLeastDetections) return fit;
  problem.groups = part_groups(inlier.frame, problem.tracks, recordings.size());
  problem.scales = slow_scales(problem.tracks);
  const std::vector<FittedSlowModel> models = fitted_models(problem);
  choose(problem, models, fit);
  const FittedSlowModel& chosen = models[fit.chosen];
  add_parameters(chosen, problem.scales, errors_of(problem, chosen, fit.is_jackknife), inlier, fit);
  return fit;
}

}  // namespace posemix
