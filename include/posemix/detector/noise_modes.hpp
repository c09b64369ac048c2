// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/detector/noise_fit.hpp"

/// Wrong poses that a detector gives again and again, as those of near-symmetries.
namespace posemix {

struct NoiseModeSettings {
  double radius_deg = 15.0;       ///< of a cluster of rotations, and the widest mode
  double least_share = 0.02;      ///< of all detections
  double least_recordings = 2.0;  ///< effective number, see NoiseMode
  std::size_t most = 6;
};

/// A cluster of wrong poses.
struct NoiseMode {
  SE3d offset;    ///< T_object_mode
  double weight;  ///< its share of the detections
  /// (sum w)^2 / sum w^2 over the weights w by recording: 1 where all are from one. What happens in
  /// one recording is a run of errors that follow each other, not a property of the detector.
  double recordings;
  double rotation_sd_deg;  ///< about the axis where it is widest
  bool accepted;           ///< by all of the settings
};

struct NoiseModesFit {
  NoiseFit fit;                  ///< the given model with the accepted modes, all of it refined
  std::vector<NoiseMode> modes;  ///< those that were tried, the heaviest cluster first
};

/// Adds modes to a model.
///
/// 1. The detections that are beyond the gate (kInlierGate) of the heaviest component, with a
///    rotation that errs by more than the radius, are clustered by rotation T_true^-1 Y, greedily:
///    the ball with the most of them, moved to the mean of what it holds until that is still, is
///    taken out, and again, as long as it has the least share.
/// 2. One component per cluster with its mean rotation and median translation as offset is added,
///    and the model refined (refine_noise).
/// 3. A mode that has not the least share, comes from too few recordings, is wider than the radius,
///    or has come within it of no offset is left out, the least heavy first, and the rest refined.
/// @throws InvalidInput for settings without clutter
NoiseModesFit add_noise_modes(std::span<const NoiseObservation> observations, const NoiseFit& fit,
                              const NoiseFitSettings& settings, const NoiseModeSettings& modes);

}  // namespace posemix
