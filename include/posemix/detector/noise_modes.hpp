// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posemix/detector/noise_em.hpp"

/// Wrong poses that a detector reports repeatedly, such as those of near-symmetries.
namespace posemix {

/// Which clusters of wrong poses become modes of a noise model.
struct NoiseModeSettings {
  double radius_deg = 15.0;   ///< radius of a cluster of rotations; a wider component is no mode
  double least_share = 0.02;  ///< least weight of a mode
  double least_recordings = 2.0;  ///< least effective number of recordings, see NoiseMode
  std::size_t most = 6;           ///< most clusters that are tried
};

/// A cluster of wrong poses.
struct NoiseMode {
  SE3d offset;    ///< T_object_mode
  double weight;  ///< share of the detections
  /// Effective number of recordings, (sum w)^2 / sum w^2 over the weights w by recording: 1 where
  /// one recording has all of them. A cluster from one recording is a run of errors that depend on
  /// each other, not a property of the detector.
  double recordings;
  double rotation_sd_deg;  ///< about the axis about which the mode is widest
  bool accepted;           ///< whether the cluster fulfils all of the settings
};

/// A model with modes.
struct NoiseModesFit {
  NoiseEmFit fit;                ///< the given model with the accepted modes, all of it refined
  std::vector<NoiseMode> modes;  ///< all that were tried, the heaviest first
};

/// Adds modes to a model.
///
/// 1. The detections beyond the gate (kInlierGate) of the heaviest component whose rotation errs by
///    more than the radius are clustered by the rotation of T_true^-1 Y, greedily: the ball that
///    holds the most of them is moved to the mean of its members until it gains none, and its
///    members are taken out; this is repeated while the ball has the least share.
/// 2. One component per cluster is added, with the mean rotation and the median translation of the
///    cluster as offset, and the model is refined (refine_noise).
/// 3. A mode with less than the least share, from too few recordings, wider than the radius, or
/// with
///    an offset within the radius is left out, the lightest first, and the rest is refined again.
/// @throws InvalidInput for settings without clutter
NoiseModesFit add_noise_modes(std::span<const NoiseObservation> observations, const NoiseEmFit& fit,
                              const NoiseEmSettings& settings, const NoiseModeSettings& modes);

}  // namespace posemix
