// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "parts.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/noise_statistics.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// Residuals of all recordings, frame by frame, and without the gross errors.
struct Residuals {
  std::array<std::vector<ResidualTrack>, 6> axes;
  std::array<std::vector<ResidualTrack>, 6> inliers;
  std::size_t gross = 0;
};

bool is_gross(const NoiseObservation& seen, const NoiseStudySettings& settings) {
  const SE3d error = seen.truth.inverse() * seen.detected;
  return degrees(error.rotation().log().norm()) > settings.gross_rotation_deg ||
         error.translation().norm() > settings.gross_translation_m;
}

Residuals collect(const std::vector<NoiseTrack>& tracks, const NoiseStudySettings& settings) {
  Residuals result;
  for (const NoiseTrack& track : tracks) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      result.axes[axis].emplace_back(track.size());
      result.inliers[axis].emplace_back(track.size());
    }
    for (std::size_t frame = 0; frame < track.size(); ++frame) {
      if (!track[frame]) continue;
      const Vector6d n =
          detection_residual(track[frame]->truth, track[frame]->detected, settings.frame);
      const bool gross = is_gross(*track[frame], settings);
      if (gross) ++result.gross;
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const double value = n[static_cast<Eigen::Index>(axis)];
        const double in_unit = axis < 3 ? degrees(value) : value;
        result.axes[axis].back()[frame] = in_unit;
        if (!gross) result.inliers[axis].back()[frame] = in_unit;
      }
    }
  }
  return result;
}

/// Counts in even bins from -reach to reach, which holds 99 % of the values.
Json histogram(std::span<const ResidualTrack> tracks, std::size_t bins) {
  std::vector<double> values;
  for (const ResidualTrack& track : tracks) {
    for (const auto& value : track) {
      if (value) values.push_back(*value);
    }
  }
  std::vector<double> sizes = values;
  for (double& size : sizes) size = std::abs(size);
  const auto at = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), sizes.begin() + at, sizes.end());
  const double reach = std::max(1.1 * sizes[static_cast<std::size_t>(at)], 1e-9);
  const double width = 2.0 * reach / static_cast<double>(bins);
  std::vector<std::size_t> counts(bins, 0);
  for (const double value : values) {
    const double place = std::floor((value + reach) / width);
    if (place >= 0.0 && place < static_cast<double>(bins))
      ++counts[static_cast<std::size_t>(place)];
  }
  return {{"reach", reach}, {"counts", counts}};
}

Json axis_json(const Residuals& residuals, std::size_t axis, const NoiseStudySettings& settings) {
  const AxisStatistics s = axis_statistics(residuals.axes[axis]);
  const Autocorrelation time = autocorrelation(residuals.axes[axis]);
  const AxisStatistics inlier = axis_statistics(residuals.inliers[axis]);
  const Autocorrelation inlier_time = autocorrelation(residuals.inliers[axis]);
  return {{"count", s.count},
          {"mean", finite_json(s.mean)},
          {"sd", finite_json(s.sd)},
          {"rms", finite_json(s.rms)},
          {"median", finite_json(s.median)},
          {"robust_sd", finite_json(s.robust_sd)},
          {"skewness", finite_json(s.skewness)},
          {"kurtosis", finite_json(s.kurtosis)},
          {"lag1_autocorrelation", finite_json(time.lag1)},
          {"correlation_frames", finite_json(time.correlation_frames)},
          {"effective_count", finite_json(time.effective_count)},
          {"inlier_sd", finite_json(inlier.sd)},
          {"inlier_lag1_autocorrelation", finite_json(inlier_time.lag1)},
          {"inlier_correlation_frames", finite_json(inlier_time.correlation_frames)},
          {"inlier_sd_of_recordings", finite_json(spread_of_means(residuals.inliers[axis]))},
          {"histogram", histogram(residuals.axes[axis], settings.bins)}};
}

/// The best model of all sizes: entry k has k + 1 components; then one with modes where there are
/// any.
struct Models {
  std::vector<NoiseFit> fits;
  std::vector<NoiseMode> modes;
  std::size_t chosen = 0;
};

double effective_bic(const NoiseFit& fit, double count, double dependent) {
  return static_cast<double>(fit.parameters) * std::log(count / dependent) -
         2.0 * fit.log_likelihood / dependent;
}

/// The least BIC, which counts frames or those that are independent.
std::size_t best_of(const std::vector<NoiseFit>& fits, double count, double dependent) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const double bic = effective_bic(fits[k], count, dependent);
    if (bic >= least || fits[k].status == EmStatus::degenerate) continue;
    least = bic;
    best = k;
  }
  return best;
}

Models fit_models(const NoiseGroup& group, std::span<const NoiseObservation> observations,
                  double dependent, const NoiseStudySettings& settings, std::size_t item) {
  RandomStream stream(settings.seed, item);
  Models models{.fits = fit_noise_sizes(observations, settings, stream), .modes = {}};
  const auto count = static_cast<double>(observations.size());
  const double counted = settings.count_frames ? 1.0 : dependent;
  models.chosen = best_of(models.fits, count, counted);
  if (!settings.modes || !group.one_class) return models;
  NoiseModesFit with_modes =
      add_noise_modes(observations, models.fits[models.chosen],
                      noise_fit_settings(settings, settings.max_components), settings.mode);
  models.modes = std::move(with_modes.modes);
  const bool any = std::any_of(models.modes.begin(), models.modes.end(),
                               [](const NoiseMode& mode) { return mode.accepted; });
  if (!any) return models;
  if (effective_bic(with_modes.fit, count, counted) <
      effective_bic(models.fits[models.chosen], count, counted))
    models.chosen = models.fits.size();
  models.fits.push_back(std::move(with_modes.fit));
  return models;
}

const char* name_of(EmStatus status) {
  if (status == EmStatus::converged) return "converged";
  return status == EmStatus::degenerate ? "degenerate" : "max_iterations";
}

Json models_json(const Models& models, double count, double dependent) {
  Json json = Json::array();
  for (std::size_t k = 0; k < models.fits.size(); ++k) {
    const NoiseFit& fit = models.fits[k];
    const auto& components = fit.noise.components();
    const auto offsets = std::count_if(components.begin(), components.end(),
                                       [](const auto& c) { return c.offset.log().norm() > 0.0; });
    json.push_back({{"components", components.size()},
                    {"offsets", offsets},
                    {"clutter", fit.noise.clutter().weight},
                    {"parameters", fit.parameters},
                    {"log_likelihood", fit.log_likelihood},
                    {"bic", fit.bic},
                    {"bic_effective", effective_bic(fit, count, dependent)},
                    {"iterations", fit.history.size() - 1},
                    {"status", name_of(fit.status)},
                    {"chosen", k == models.chosen},
                    {"noise", noise_to_json(fit.noise)}});
  }
  return json;
}

/// The heaviest component without an offset: it says what an inlier is.
const NoiseComponent& inlier_of(const DetectorNoise& noise) {
  const auto& components = noise.components();
  const auto centred = std::find_if(components.begin(), components.end(),
                                    [](const auto& c) { return c.offset.log().norm() == 0.0; });
  return centred == components.end() ? components.front() : *centred;
}

}  // namespace

std::vector<NoiseTrack> tracks_of(const NoiseGroup& group) {
  std::vector<NoiseTrack> tracks;
  std::map<std::string, std::size_t> recordings;
  for (const ResidualSet& set : group.sets) {
    const std::size_t recording =
        recordings.emplace(set.recording, recordings.size()).first->second;
    NoiseTrack& track = tracks.emplace_back();
    for (std::size_t frame = 0; frame < set.truth.size(); ++frame) {
      if (!set.truth[frame]) continue;
      track.emplace_back();
      if (set.detected[frame])
        track.back() = NoiseObservation{*set.truth[frame], *set.detected[frame], recording};
    }
  }
  return tracks;
}

std::vector<NoiseObservation> observations_of(std::span<const NoiseTrack> tracks) {
  std::vector<NoiseObservation> observations;
  for (const NoiseTrack& track : tracks) {
    for (const auto& seen : track) {
      if (seen) observations.push_back(*seen);
    }
  }
  return observations;
}

nlohmann::ordered_json study_noise(const NoiseGroup& group, const NoiseStudySettings& settings,
                                   std::size_t item) {
  const std::vector<NoiseTrack> tracks = tracks_of(group);
  const std::vector<NoiseObservation> observations = observations_of(tracks);
  constexpr std::size_t kFewest = 20;
  if (observations.size() < kFewest) {
    throw InvalidInput(fmt::format("study noise: {} detections of {} with a truth, expected {}",
                                   observations.size(), group.object, kFewest));
  }
  const Residuals residuals = collect(tracks, settings);
  const auto count = static_cast<double>(observations.size());
  const auto any = [&](bool ResidualSet::*flag) {
    return std::any_of(group.sets.begin(), group.sets.end(),
                       [&](const ResidualSet& set) { return set.*flag; });
  };
  Json result = {{"detector", group.detector},
                 {"object", group.object},
                 {"recordings", group.sets.size()},
                 {"proxy", any(&ResidualSet::proxy)},
                 {"symmetric", any(&ResidualSet::symmetric)},
                 {"frame", name_of(settings.frame)},
                 {"gross_errors", static_cast<double>(residuals.gross) / count}};
  std::vector<double> dependent;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    Json& entry = result["axes"].emplace_back(axis_json(residuals, axis, settings));
    if (entry["correlation_frames"].is_number()) dependent.push_back(entry["correlation_frames"]);
  }
  std::sort(dependent.begin(), dependent.end());
  const double middle = dependent.empty() ? 1.0 : dependent[dependent.size() / 2];
  const Models models = fit_models(group, observations, middle, settings, item);
  result["models"] = models_json(models, count, middle);
  result["modes"] = modes_json(models.modes);
  const NoiseComponent& inlier = inlier_of(models.fits[models.chosen].noise);
  result["correlation"] = correlation_json(noise_correlation(tracks, inlier));
  if (settings.folds > 1)
    result["validation"] = validation_json(cross_validate(tracks, settings, item));
  return result;
}

}  // namespace posemix
