// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/detector/noise_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "detector/noise_assembly.hpp"
#include "detector/noise_sizes.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

namespace posemix {
namespace {

constexpr std::array kFrames{NoiseFrame::object, NoiseFrame::camera, NoiseFrame::ray};

/// The models of one frame.
struct FrameModels {
  NoiseFrame frame;
  double dependent_frames;
  std::vector<NoiseEmFit> fits;
  std::vector<NoiseMode> modes = {};
  std::size_t chosen = 0;
};

void check(const NoiseFitSettings& settings) {
  require(settings.max_components > 0, "noise model: 0 components, expected one or more");
  kUnitInterval.check(settings.least_clutter, "noise model: least_clutter");
  if (settings.free_means && settings.frame != NoiseFrame::object) {
    throw InvalidInput(fmt::format(
        "noise model: free means in the frame {}, expected free_means = false or the frame object",
        settings.frame ? word_of(*settings.frame) : "that fits best"));
  }
  require(!settings.free_means || !settings.clutter,
          "noise model: free means beside clutter, expected free_means = false (with modes = true "
          "for offset poses) or clutter = false");
  require(!settings.modes || settings.clutter,
          "noise model: modes without clutter, expected clutter = true or modes = false");
  if (settings.criterion == NoiseCriterion::cross_validation && settings.folds < 2) {
    throw InvalidInput(fmt::format(
        "noise model: cross validation with {} folds, expected two or more", settings.folds));
  }
}

/// Median over the coordinates of the number of frames that count as one.
double median_correlation_frames(std::span<const NoiseTrack> tracks, NoiseFrame frame) {
  std::vector<double> dependent;
  for (const auto& axis : residual_tracks(tracks, frame)) {
    const double frames = autocorrelation(axis).correlation_frames;
    if (std::isfinite(frames)) dependent.push_back(frames);
  }
  std::sort(dependent.begin(), dependent.end());
  return dependent.empty() ? 1.0 : dependent[dependent.size() / 2];
}

/// Chooses between models of `count` detections by the BIC.
class BicChoice {
 public:
  BicChoice(std::size_t count, NoiseCriterion criterion)
      : count_(static_cast<double>(count)),
        is_by_independent_(criterion == NoiseCriterion::bic_independent_frames) {}

  double bic(const NoiseEmFit& fit, const FrameModels& models) const {
    return bic_of_independent_frames(fit, count_,
                                     is_by_independent_ ? models.dependent_frames : 1.0);
  }

  /// The model of the least BIC that is not degenerate.
  std::size_t best(const FrameModels& models) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < models.fits.size(); ++k) {
      const double now = bic(models.fits[k], models);
      if (now >= least || models.fits[k].status == EmStatus::degenerate) continue;
      least = now;
      best = k;
    }
    return best;
  }

 private:
  double count_;
  bool is_by_independent_;
};

void add_modes(std::span<const NoiseObservation> observations, const NoiseFitSettings& settings,
               const BicChoice& choice, FrameModels& models) {
  NoiseModesFit with_modes = add_noise_modes(
      observations, models.fits[models.chosen],
      internal::em_settings(settings, models.frame, settings.max_components), settings.mode);
  models.modes = std::move(with_modes.modes);
  const bool any = std::any_of(models.modes.begin(), models.modes.end(),
                               [](const NoiseMode& mode) { return mode.accepted; });
  if (!any) return;
  if (choice.bic(with_modes.fit, models) < choice.bic(models.fits[models.chosen], models))
    models.chosen = models.fits.size();
  models.fits.push_back(std::move(with_modes.fit));
}

/// The row of the greatest log density among the models that the settings allow.
std::optional<NoiseValidation> best_validated(const std::vector<NoiseValidation>& rows,
                                              const NoiseFitSettings& settings) {
  std::optional<NoiseValidation> best;
  for (const NoiseValidation& row : rows) {
    if (row.clutter != settings.clutter || (settings.frame && row.frame != *settings.frame))
      continue;
    if (!best || row.log_density > best->log_density) best = row;
  }
  return best;
}

NoiseFit result_of(FrameModels models, std::span<const NoiseTrack> tracks,
                   const NoiseFitSettings& settings, std::vector<NoiseValidation> validation) {
  const NoiseEmFit& chosen = models.fits[models.chosen];
  const NoiseComponent& inlier = chosen.noise.components()[internal::inlier_index(chosen.noise)];
  const NoiseCorrelation correlation = noise_correlation(tracks, inlier);
  SlowErrorFit slow_error = fit_slow_error(tracks, inlier);
  DetectorNoise noise =
      internal::assembled_noise(chosen.noise, slow_error, correlation, tracks,
                                settings.least_clutter, settings.clutter_volume_m3);
  return {.noise = std::move(noise),
          .frame = models.frame,
          .log_likelihood = chosen.log_likelihood,
          .parameters = chosen.parameters,
          .bic = chosen.bic,
          .fits = std::move(models.fits),
          .chosen = models.chosen,
          .dependent_frames = models.dependent_frames,
          .modes = std::move(models.modes),
          .correlation = correlation,
          .slow_error = std::move(slow_error),
          .validation = std::move(validation)};
}

}  // namespace

double bic_of_independent_frames(const NoiseEmFit& fit, double count, double dependent_frames) {
  return static_cast<double>(fit.parameters) * std::log(count / dependent_frames) -
         2.0 * fit.log_likelihood / dependent_frames;
}

NoiseFit fit_noise(std::span<const NoiseTrack> tracks, const NoiseFitSettings& settings,
                   RandomStream& stream) {
  check(settings);
  const std::vector<NoiseObservation> observations = observations_of(tracks);
  std::vector<NoiseValidation> validation;
  if (settings.folds > 1) validation = cross_validate(tracks, settings, stream);
  std::optional<NoiseValidation> validated;
  if (settings.criterion == NoiseCriterion::cross_validation)
    validated = best_validated(validation, settings);
  const BicChoice choice(observations.size(), settings.criterion);
  std::optional<FrameModels> best;
  for (const NoiseFrame frame : kFrames) {
    if (frame != settings.frame.value_or(validated ? validated->frame : frame)) continue;
    FrameModels models{.frame = frame,
                       .dependent_frames = median_correlation_frames(tracks, frame),
                       .fits = internal::fit_noise_sizes(observations, settings, frame, stream)};
    models.chosen =
        validated ? std::min(validated->components, models.fits.size()) - 1 : choice.best(models);
    if (settings.modes) add_modes(observations, settings, choice, models);
    if (!best || models.fits[models.chosen].bic < best->fits[best->chosen].bic)
      best = std::move(models);
  }
  return result_of(*std::move(best), tracks, settings, std::move(validation));
}

}  // namespace posemix
