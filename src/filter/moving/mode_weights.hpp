// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "posemix/lie/lie.hpp"

/// What a detector shows under one hypothesis for the place of an object (docs/moving-objects.md,
/// "The detector").
namespace posemix::internal {

class DetectorModes;

/// A run of wrong detections at the place of a hypothesis.
struct WrongRun {
  std::uint64_t place;    ///< its id; kAnyPlace where it was not seen yet, or was dropped
  Eigen::ArrayXd weight;  ///< by motion model
  /// The orientation of that place from this hypothesis' when the run was first met, and its
  /// covariance: a turned detection turns with the object.
  std::optional<SO3d> offset = {};
  Eigen::Matrix3d offset_covariance = Eigen::Matrix3d::Zero();
  double log_kept = 0.0;  ///< log likelihood that it was kept, up to a constant
};
inline constexpr std::uint64_t kAnyPlace = 0;

/// The part of what is at one place that is at another.
struct PlaceShare {
  std::uint64_t place;
  double share;
};

/// The weights p_hkm of one hypothesis h over motion models k and modes m of the detector.
struct ModeWeights {
  Eigen::ArrayXXd right;       ///< models x right modes
  std::vector<WrongRun> runs;  ///< the first one is at any place

  ModeWeights() = default;
  ModeWeights(Eigen::Index models, Eigen::Index modes);
  Eigen::ArrayXd by_model() const;
  double total() const { return by_model().sum(); }
  ModeWeights& operator*=(double factor);
  /// Factors by model.
  void scale(const Eigen::ArrayXd& factor);
  void add(const ModeWeights& other);
  /// Eq. (7): p_k <- sum_l p_l P_lk.
  void change_models(const Eigen::MatrixXd& transition);
  /// Eq. (10): the modes are kept with the probability `stay`, else drawn anew; runs are at one of
  /// `places` with the probability `recurring`, where there are any.
  void draw_modes(double stay, const DetectorModes& modes, double in_run, double recurring,
                  std::span<const std::uint64_t> places);
  Eigen::ArrayXd& run_at(std::uint64_t place);
  /// Runs at a place become such of another; `own` says that it is the place of this hypothesis,
  /// where the detector is right.
  void redirect(std::uint64_t from, std::uint64_t to, bool own);
  /// Runs at a place are at several, of shares that sum to one.
  void divide(std::uint64_t place, std::span<const PlaceShare> shares);
};

}  // namespace posemix::internal
