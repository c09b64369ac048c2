// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/base/words.hpp"
#include "posemix/detector/noise_correlation.hpp"
#include "posemix/detector/noise_em.hpp"
#include "posemix/detector/noise_modes.hpp"
#include "posemix/detector/slow_error_fit.hpp"

/// The noise model of a detector, learned from detections with their truth.
namespace posemix {

/// What decides between models.
enum class NoiseCriterion {
  bic,                     ///< the least BIC, with all detections taken for independent
  bic_independent_frames,  ///< the least BIC, with correlated detections counted as fewer
  cross_validation         ///< the greatest log density of recordings that were held out
};

/// The words of NoiseCriterion in messages and in Python.
template <>
inline constexpr WordTable<NoiseCriterion, 3> words<NoiseCriterion>{{
    {"bic", NoiseCriterion::bic},
    {"bic_independent_frames", NoiseCriterion::bic_independent_frames},
    {"cross_validation", NoiseCriterion::cross_validation},
}};

/// Settings of fit_noise. Bounds of rotations are in degrees, of translations in metres, or for
/// NoiseFrame::ray in fractions of the range.
struct NoiseFitSettings {
  std::size_t max_components = 4;  ///< without modes; models of 1, 2, ... components are fitted
  int restarts = 6;                ///< starts of EM for every number of components
  /// The axes of the covariances; where empty they are chosen, by the cross validation if that is
  /// the criterion, else by the BIC of all detections.
  std::optional<NoiseFrame> frame = {};
  bool full_covariance = false;  ///< else diagonal
  /// All components may have offsets, found by EM alone; for the object's frame without clutter.
  bool free_means = false;
  bool clutter = true;  ///< models have clutter, whose weight is estimated
  double clutter_volume_m3 = 1.0;
  double least_clutter = 1e-3;  ///< least weight of clutter: a detector that has not failed yet may
  bool modes = true;            ///< modes are looked for (add_noise_modes); needs clutter
  NoiseModeSettings mode = {};
  NoiseCriterion criterion = NoiseCriterion::bic;
  std::size_t folds = 0;              ///< of the cross validation; none where below two
  double max_rotation_sd_deg = 90.0;  ///< bound of a component
  double max_translation_sd_m = 1.0;
};

/// How well a kind of model predicts detections that it was not fitted to.
struct NoiseValidation {
  NoiseFrame frame;
  bool clutter;
  std::size_t components;
  double log_density;                ///< mean per detection [nats]
  std::vector<double> by_fold = {};  ///< the same by fold
  double below_best = 0.0;           ///< difference to the best of all kinds [nats]
  double standard_error = 0.0;       ///< of that difference, from its values by fold
};

/// A noise model, and how it was found.
struct NoiseFit {
  /// The chosen model with its dependence, for a filter as it is.
  DetectorNoise noise;
  NoiseFrame frame;
  /// Of the chosen model of `fits`: sum over the detections [nats], as noise_log_density.
  double log_likelihood;
  std::size_t parameters;  ///< free parameters
  double bic;              ///< parameters log(detections) - 2 log_likelihood
  /// The models in the frame: entry k has k + 1 components; then, where a mode is accepted, the
  /// best of them with modes.
  std::vector<NoiseEmFit> fits;
  std::size_t chosen;  ///< index of the chosen model in `fits`
  /// Number of detections that count as one: median over the coordinates of the residual.
  double dependent_frames;
  std::vector<NoiseMode> modes;  ///< modes that were tried
  NoiseCorrelation correlation;  ///< of the errors about the heaviest component without offset
  SlowErrorFit slow_error;       ///< of the same component: its white, slow and common parts
  std::vector<NoiseValidation> validation;  ///< empty without cross validation
};

/// Learns the noise of a detector from the detections of one class of objects with their truth.
///
/// 1. Models of 1, 2, ... components are fitted by EM (fit_noise_components), and the criterion
///    chooses one of them, and the frame where that is not given.
/// 2. Modes are added (add_noise_modes) and kept where that lowers the BIC.
/// 3. The errors of inliers are separated into white, slow and common parts (fit_slow_error). Wider
///    components lose the slow and the common part, and their run length and the mode time are
///    measured on the indicator of detections beyond the gate (noise_correlation).
/// 4. Clutter gets its least weight, also where the models that were fitted have none.
/// @throws InvalidInput for fewer than two detections, for settings that contradict each other, and
/// for stamps that decrease
NoiseFit fit_noise(std::span<const NoiseTrack> tracks, const NoiseFitSettings& settings,
                   RandomStream& stream);

/// Models of 1 to max_components components, with and without clutter, in all frames, each fitted
/// to all folds but one and tried on that. Folds are made of whole recordings, or where there are
/// fewer recordings than folds, of blocks of time. Every fit begins with a copy of the stream.
/// Empty for fewer than two folds.
std::vector<NoiseValidation> cross_validate(std::span<const NoiseTrack> tracks,
                                            const NoiseFitSettings& settings,
                                            const RandomStream& stream);

/// The BIC where `dependent_frames` of the `count` detections count as one, of the independent
/// ones.
double bic_of_independent_frames(const NoiseEmFit& fit, double count, double dependent_frames);

}  // namespace posemix
