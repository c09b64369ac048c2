// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/detector/noise_observation.hpp"
#include "posemix/mixture/em.hpp"

/// Expectation maximisation for a noise model with a given number of components. fit_noise chooses
/// the number, adds modes and estimates what detections have in common.
namespace posemix {

/// Log density of every detection under the model [nats; per rad^3 m^3, Haar measure]: of a
/// component log N(n; 0, P) - log |det J_l(n)|, less 3 log range along the viewing ray. A slow
/// error and one in common are a part of every P (DetectorNoise::as_white).
Eigen::ArrayXd noise_log_density(const DetectorNoise& noise,
                                 std::span<const NoiseObservation> observations);

/// The model to be fitted.
struct NoiseEmSettings {
  std::size_t components = 1;
  NoiseFrame frame = NoiseFrame::object;
  bool clutter = false;  ///< with clutter of the volume below, whose weight is estimated
  double clutter_volume_m3 = 1.0;
  double least_clutter = 0.0;  ///< least weight of clutter: a detector that has not failed yet may
  /// Covariances diagonal or full and their bounds, convergence, number of starts. Units are those
  /// of the residual. The fields `components` and `fixed_means` are ignored.
  EmSettings em = {};
};

/// A noise model fitted by expectation maximisation.
struct NoiseEmFit {
  DetectorNoise noise;          ///< the heaviest component first
  double log_likelihood;        ///< sum over the observations [nats], as noise_log_density
  std::vector<double> history;  ///< log-likelihood of the start and after every step
  EmStatus status;
  std::size_t parameters;  ///< free parameters
  double bic;              ///< parameters log(observations) - 2 log_likelihood
};

/// EM from a given start, whose components keep their frames. Offsets that are not the identity are
/// estimated, the others stay zero, and so does clutter of weight zero; clutter whose weight falls
/// below 1e-9 becomes zero. Every step is an E-step with the M-step of weights and covariances, in
/// turn with a Gauss-Newton step of the offsets, which is shortened until it does not lower the
/// likelihood: `history` never falls by more than rounding.
/// @throws InvalidInput when there are no observations, for a pose that check_pose refuses, and for
/// settings out of range
NoiseEmFit refine_noise(std::span<const NoiseObservation> observations, const DetectorNoise& start,
                        const NoiseEmSettings& settings);

/// The most likely of refine_noise's ends from `em.restarts` concentric starts without offsets; for
/// one component without clutter, where the likelihood has a single maximum, from one start.
/// @throws InvalidInput for fewer observations than two per component, and as refine_noise
NoiseEmFit fit_noise_components(std::span<const NoiseObservation> observations,
                                const NoiseEmSettings& settings, RandomStream& stream);

}  // namespace posemix
