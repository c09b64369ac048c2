// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "study/noise/item.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/base/units.hpp"
#include "posemix/detector/noise_fit.hpp"
#include "study/engine/settings_json.hpp"
#include "study/noise/json.hpp"
#include "study/noise/slow_report.hpp"

namespace posemix {
namespace {

using Json = nlohmann::ordered_json;

/// Residuals of all recordings, frame by frame, and without the gross errors.
struct Residuals {
  std::array<std::vector<ResidualTrack>, 6> axes;
  std::array<std::vector<ResidualTrack>, 6> inliers;
  std::size_t gross = 0;
};

NoiseFrame frame_of(const NoiseStudySettings& settings) {
  return settings.fit.frame.value_or(NoiseFrame::object);
}

bool is_gross(const NoiseObservation& seen, const NoiseStudySettings& settings) {
  const SE3d error = seen.truth.inverse() * seen.detected;
  return degrees(error.rotation().log().norm()) > settings.gross_rotation_deg ||
         error.translation().norm() > settings.gross_translation_m;
}

Residuals collect(const std::vector<NoiseTrack>& tracks, const NoiseStudySettings& settings) {
  Residuals result{.axes = residual_tracks(tracks, frame_of(settings)), .inliers = {}};
  result.inliers = result.axes;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (std::size_t frame = 0; frame < tracks[i].size(); ++frame) {
      if (!tracks[i][frame] || !is_gross(*tracks[i][frame], settings)) continue;
      ++result.gross;
      for (auto& axis : result.inliers) axis[i][frame] = std::nullopt;
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
  const double reach = std::max(1.1 * quantile(std::move(sizes), 0.99), 1e-9);
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

Json models_json(const NoiseFit& models, double count) {
  Json json = Json::array();
  for (std::size_t k = 0; k < models.fits.size(); ++k) {
    const NoiseEmFit& fit = models.fits[k];
    const auto& components = fit.noise.components();
    const auto offsets = std::count_if(components.begin(), components.end(),
                                       [](const auto& c) { return c.offset.log().norm() > 0.0; });
    json.push_back(
        {{"components", components.size()},
         {"offsets", offsets},
         {"clutter", fit.noise.clutter().weight},
         {"parameters", fit.parameters},
         {"log_likelihood", fit.log_likelihood},
         {"bic", fit.bic},
         {"bic_effective", bic_of_independent_frames(fit, count, models.dependent_frames)},
         {"iterations", fit.history.size() - 1},
         {"status", word_of(fit.status)},
         {"chosen", k == models.chosen},
         {"noise", noise_json(fit.noise)}});
  }
  return json;
}

}  // namespace

nlohmann::ordered_json study_noise(const NoiseGroup& group, const NoiseStudySettings& settings,
                                   std::size_t item) {
  const std::vector<NoiseTrack> tracks = tracks_of(group);
  const std::size_t detections = observations_of(tracks).size();
  constexpr std::size_t kFewest = 20;
  if (detections < kFewest) {
    throw InvalidInput(fmt::format("study noise: {} detections of {} with a truth, expected {}",
                                   detections, group.object, kFewest));
  }
  const Residuals residuals = collect(tracks, settings);
  const auto count = static_cast<double>(detections);
  const auto any = [&](bool ResidualSet::*flag) {
    return std::any_of(group.sets.begin(), group.sets.end(),
                       [&](const ResidualSet& set) { return set.*flag; });
  };
  Json result = {{"detector", group.detector},
                 {"object", group.object},
                 {"recordings", group.sets.size()},
                 {"proxy", any(&ResidualSet::proxy)},
                 {"symmetric", any(&ResidualSet::symmetric)},
                 {"frame", word_of(frame_of(settings))},
                 {"gross_errors", static_cast<double>(residuals.gross) / count}};
  for (std::size_t axis = 0; axis < 6; ++axis)
    result["axes"].push_back(axis_json(residuals, axis, settings));
  NoiseFitSettings fit_settings = settings.fit;
  fit_settings.frame = frame_of(settings);
  fit_settings.modes = settings.fit.modes && group.one_class;
  RandomStream stream(settings.seed, item);
  const NoiseFit fit = fit_noise(tracks, fit_settings, stream);
  result["models"] = models_json(fit, count);
  result["modes"] = modes_json(fit.modes);
  result["correlation"] = correlation_json(fit.correlation);
  result["slow_error"] = slow_error_json(fit.slow_error);
  result["noise"] = dependent_noise_json(fit.noise);
  if (settings.fit.folds > 1) result["validation"] = validation_json(fit.validation);
  return result;
}

}  // namespace posemix
