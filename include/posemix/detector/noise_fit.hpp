// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/base/linear.hpp"
#include "posemix/base/random.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/mixture/em.hpp"

/// The noise model of a detector fitted to detections with their truth.
namespace posemix {

/// A detection with its truth, T_camera_object both.
struct NoiseObservation {
  SE3d truth;
  SE3d detected;
  std::size_t recording = 0;  ///< observations of one recording belong together
};

/// The residual n of a detection Y [rad, m; for NoiseFrame::ray the translation as a fraction of
/// the range]: Y = T Exp(n) along the object's axes (midway-merge paper, eq. 32), or the same along
/// the camera's axes or the viewing ray, with the rotation about the object's origin in all. With
/// T = T_camera_object offset it is the n of a NoiseComponent.
Vector6d detection_residual(const SE3d& truth, const SE3d& detected, NoiseFrame frame);

/// Log density of every detection under the model [nats; per rad^3 m^3, Haar measure]: of a
/// component log N(n; 0, P) - log |det J_l(n)|, less 3 log range along the viewing ray.
Eigen::ArrayXd noise_log_density(const DetectorNoise& noise,
                                 std::span<const NoiseObservation> observations);

/// The model to be fitted.
struct NoiseFitSettings {
  std::size_t components = 1;
  NoiseFrame frame = NoiseFrame::object;
  bool clutter = false;  ///< with clutter of the volume below, whose weight is estimated
  double clutter_volume_m3 = 1.0;
  double least_clutter = 0.0;  ///< clutter's least weight: a detector that has not failed yet may
  /// Covariances diagonal or full and their bounds, convergence, number of starts. Units: of the
  /// residual. `components` and `fixed_means` are not looked at.
  EmSettings em = {};
};

/// A fitted model.
struct NoiseFit {
  DetectorNoise noise;          ///< the heaviest component first
  double log_likelihood;        ///< sum over the observations [nats], as noise_log_density
  std::vector<double> history;  ///< log-likelihood of the start and after every step
  EmStatus status;
  std::size_t parameters;  ///< free parameters
  double bic;              ///< parameters log(observations) - 2 log_likelihood
};

/// EM from a start, whose components' frames stay. Offsets that are not the identity are estimated,
/// the others stay zero, and so does clutter of weight zero; one that falls below 1e-9 becomes
/// zero. Every step is an E-step with the M-step of weights and covariances, in turn with a
/// Gauss-Newton step of the offsets, which is shortened until it does not lower the likelihood:
/// `history` never falls by more than rounding.
/// @throws InvalidInput when there are no observations
NoiseFit refine_noise(std::span<const NoiseObservation> observations, const DetectorNoise& start,
                      const NoiseFitSettings& settings);

/// The most likely of refine_noise's ends from `em.restarts` concentric starts without offsets, for
/// one component without clutter from a single one.
/// @throws InvalidInput for fewer observations than two per component
NoiseFit fit_noise(std::span<const NoiseObservation> observations, const NoiseFitSettings& settings,
                   RandomStream& stream);

}  // namespace posemix
