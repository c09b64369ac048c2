// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/mixture/projected_operations.hpp"
#include "posemix/reduction/reduce.hpp"
#include "study/engine/study.hpp"

/// The salt box (MPG paper, section VI, Figs. 2-6): the pose of a box from features on its front.
/// Every feature determines its position, less well along the line of sight, and its turn about the
/// line of sight, but its tilt only within a cone; its pose is a mixture of seven projected
/// Gaussians. The paper states no numbers: those here are our own.
namespace posemix {

using PoseMpg = Mixture<ProjectedGaussian<SE3d>>;

/// A feature on the box and its detection.
struct SaltBoxFeature {
  std::string name;
  Eigen::Vector3d point;  ///< position on the box, whose axes it shares [m]
  SE3d detected;          ///< T_camera_feature
};

/// Settings of `study salt-box`. Rotations in radians, translations in metres.
struct SaltBoxSettings {
  std::vector<SaltBoxFeature> features;  ///< at least two
  double tilt_sd =
      radians(3.66);              ///< deviation of an element about the x and y axes of the feature
  double spin_sd = radians(3.0);  ///< about its z axis
  /// The six outer elements are tilted by this. With tilt_sd, the tilt then has the variance of a
  /// uniform disc of 15 degrees.
  double cone = radians(10.0);
  double lateral_sd = 0.0015;  ///< across the line of sight
  double depth_sd = 0.003;     ///< along it
  CompositionRule composition = CompositionRule::jacobian;
  FusionRule fusion = FusionRule::mode;
  PairRule pair = PairRule::symmetric_kl;
  MergeRule merge = MergeRule::midway;
  std::size_t drop = 10;     ///< lightest components dropped after a fusion
  std::size_t keep = 10;     ///< components left by merging after that
  std::size_t flags = 60;    ///< samples per mixture in the pictures
  std::size_t trials = 100;  ///< simulated detections of all features
  /// depth_sd of the trials: the worse the depth, the more the tilt of the box depends on the tilts
  /// of the features.
  double trial_depth_sd = 0.01;
  std::uint64_t seed = 1;
};

/// The detections of the example: truth `salt_box_truth()`, errors of the tilt drawn for every
/// feature separately.
SaltBoxSettings default_salt_box();
/// T_camera_box of the example.
SE3d salt_box_truth();

/// The pose of a feature in the camera frame: seven elements of equal weight.
PoseMpg feature_mixture(const SaltBoxSettings& settings, const SaltBoxFeature& feature);
/// The pose of the box in the camera frame from one feature: composed with the fixed pose of the
/// box in the feature's frame.
PoseMpg object_mixture(const SaltBoxSettings& settings, const SaltBoxFeature& feature);

/// One stage of the example.
struct SaltBoxStage {
  std::string name;
  PoseMpg mixture;
  /// For a fusion: the log of the integral of the product over the half sphere of quaternions and
  /// the translations, the paper's measure [nats].
  std::optional<double> log_evidence;
};

/// All stages in order: for every feature `feature_NAME` and `object_NAME`; from the second on
/// `fused_NAME`, `dropped_NAME`, `merged_NAME`, each with the mixture merged before.
std::vector<SaltBoxStage> run_salt_box(const SaltBoxSettings& settings);

/// Settings of the reduction after a fusion.
ReductionSettings salt_box_reduction(const SaltBoxSettings& settings);

/// Standard deviations of a mixture under the distribution of the one projected Gaussian with its
/// moments.
struct PoseSpread {
  SE3d mean;
  Eigen::Vector3d rotation;     ///< about the axes of the mean [rad]
  Eigen::Vector3d translation;  ///< along the axes of the reference frame [m]
  Matrix6d covariance;          ///< of [2 u; t] under the distribution
};
PoseSpread spread_of(const PoseMpg& mixture);

/// Reads settings; keys as in docs/studies.md.
/// @throws InvalidInput naming file, line and key
SaltBoxSettings read_salt_box_settings(const TomlTable& table);

/// The study: one work item for the example and one per trial. Files: study.json (rows `stage`,
/// `components`, `log_evidence`, `rotation_std_deg`, `translation_std_m` and more), reductions.csv
/// (the loss of dropping and merging after the first fusion, by rule), trials.csv (errors and
/// normalised squared errors with tilts drawn feature by feature, and with one tilt for all
/// features of a view), flags_STAGE.svg, posterior.json (the last mixture).
Study make_salt_box_study(const SaltBoxSettings& settings);

}  // namespace posemix
