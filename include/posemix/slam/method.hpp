// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/smoothing.hpp"

/// The methods of object SLAM by name, the same for C++, Python, sequence files and studies.
namespace posemix {

/// Frames that the method `fixed_lag` looks ahead.
inline constexpr std::size_t kSmoothLag = 20;

/// A tracker with its settings, and what belongs to it.
struct SlamMethod {
  std::string name;         ///< as in files: "gm-iekf"
  std::string description;  ///< one line
  TrackerSettings tracker;
  std::optional<SmoothingSettings> smoothing = {};  ///< estimates that also look ahead
  /// Whether the detector's noise is used as one Gaussian of the same second moments.
  bool single_gaussian = false;
  /// Sets what makes the method itself, where it has such settings; for use after others were
  /// changed.
  void (*restore)(GaussianSumSettings&) = nullptr;

  /// Object SLAM by this method, live, for a camera that moves in this way.
  /// @throws InvalidInput as ObjectSlam and `models`, and for a method that smooths: `smoother` is
  /// its live form
  ObjectSlam live(const PoseDensity& camera, std::vector<ObjectModel> objects,
                  const MotionSettings& motion = {}) const;
  /// The same for a method that smooths.
  /// @throws InvalidInput as FixedLagSmoother and `models`, and for a method that does not smooth
  FixedLagSmoother smoother(const PoseDensity& camera, std::vector<ObjectModel> objects,
                            const MotionSettings& motion = {}) const;
  /// Settings of ObjectSlam for a camera that moves in this way, without the smoothing.
  ObjectSlamSettings settings(const MotionSettings& motion = {}) const;
  /// The object models as the method takes them.
  /// @throws InvalidInput when single_gaussian is set and a noise has no single Gaussian
  std::vector<ObjectModel> models(std::vector<ObjectModel> models) const;
  /// For display, with the settings that were chosen: "gm-iekf (midway)", "rbpf (300 particles)".
  /// Every method has another title.
  std::string title() const;
};

/// All methods:
///  - multi_object, smoothed, fixed_lag: MultiObjectSlam, and the same with smoothing to the end or
///    over kSmoothLag frames;
///  - gm-iekf: GaussianSumSlam with the library's own settings;
///  - tangent_of_larger, midway, midway_iterated: the filters of the midway-merge paper (section VI
///    and Algorithm 1, N_h = 12 for several objects);
///  - published: midway as in the program that its authors published, which merges from 16
///    components on and transports covariances by a truncated series;
///  - riekf, riekf_gated, riekf_cauchy: the right-invariant extended Kalman filter, one linearised
///    hypothesis and one Gaussian of noise; with a gate of 0.999; with a Cauchy loss;
///  - max_mixture: one linearised hypothesis that uses for each detection the one noise component
///    (or clutter) of the largest weighted likelihood, the max-mixture of Olson and Agarwal (2013)
///    as a filter;
///  - rbpf: ParticleSlam.
const std::vector<SlamMethod>& slam_methods();

/// @throws InvalidInput for another name, with those that there are
const SlamMethod& find_slam_method(std::string_view name);

}  // namespace posemix
