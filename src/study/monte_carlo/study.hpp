// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "study/engine/study.hpp"

/// The midway-merge paper's Monte-Carlo simulation (section VII-A, Table I, Fig. 4): a camera goes
/// once around a mug, with odometry of growing noise.
namespace posemix {

/// The camera's path in the object's frame, z up, at s from 0 to 1 over the recording:
///   p(s) = (r cos a, r sin a, h + w sin 2a),  a = 2 pi turns s,
/// looking at the object's origin with the image's x axis horizontal. The world frame is the
/// frame of the first camera.
struct MonteCarloPath {
  double radius_m = 3.0;
  double height_m = 1.2;
  double height_swing_m = 0.3;
  std::size_t turns = 1;
  std::size_t detections = 1000;
  std::size_t odometry_per_detection = 10;
  double detection_period_s = 1.5;
};

/// Settings of the simulation, and the filters. The paper gives the detector's and the odometry's
/// noise, N_h = 4 and 100 runs; the rest is chosen such that its figures are reproduced.
struct MonteCarloStudySettings {
  std::size_t runs = 400;
  /// The odometry's covariance is multiplied by ten to this power.
  std::vector<double> noise_exponents{0, 1, 2, 3, 4, 5};
  std::vector<std::string> methods{"riekf", "tangent_of_larger", "midway", "iterated"};
  std::uint64_t seed = 1;
  MonteCarloPath path;
  /// Covariance of the odometry per second (right perturbation, camera frame): 0.026 deg, 2 mm.
  Matrix6d odometry =
      pose_covariance(Eigen::Vector3d::Constant(radians(0.026)), Eigen::Vector3d::Constant(2e-3));
  /// Covariance of the camera's first pose (left perturbation, world frame): 0.35 deg, 1 cm.
  Matrix6d camera_start =
      pose_covariance(Eigen::Vector3d::Constant(radians(0.35)), Eigen::Vector3d::Constant(0.01));
  /// Covariance of the object's first pose (right perturbation, object frame): 4 deg, 1 cm.
  Matrix6d object_start =
      pose_covariance(Eigen::Vector3d::Constant(radians(4.0)), Eigen::Vector3d::Constant(0.01));
  /// The detector's noise, in the simulation and in the filter: eq. 36.
  DetectorNoise detector{
      {{.weight = 0.7,
        .covariance = pose_covariance(Eigen::Vector3d::Constant(radians(4.0)),
                                      Eigen::Vector3d::Constant(0.01))},
       {.weight = 0.3,
        .covariance = pose_covariance({radians(4.0), radians(4.0), radians(12.0)},
                                      Eigen::Vector3d::Constant(0.01))}}};
  std::size_t max_components = 4;  ///< N_h
  double prune_below = 5e-6;
};

/// Names of the methods, in the order in which they are documented.
///
/// All but the last three update linearly, as the paper does, and merge the most distant pair:
/// - midway, tangent_of_larger, moment_matched: merges by the rule of that name;
/// - runnalls_pairs, largest_with_smallest: midway merges of pairs chosen by another rule;
/// - no_merge_64: no merges, the 64 heaviest components are kept;
/// - riekf: one Gaussian, with the second moment of the detector's noise;
/// - iterated, iterated_tangent_of_larger, iterated_riekf: the iterated update in relative poses.
const std::vector<std::string>& monte_carlo_methods();

/// Errors of one filter in one run, over its frames after every detection.
struct MonteCarloErrors {
  double robot_rotation_rmse_deg;   ///< of the rotation part of Log(T_estimate T_true^-1)
  double object_rotation_rmse_deg;  ///< the same for T_world_object
  double anees;          ///< mean of e^T P^-1 e / 12, e = Log(X_true X_estimate^-1) of both poses
  double relative_nees;  ///< mean of e^T P^-1 e / 6 of T_camera_object
  double seconds;        ///< processor time of the filter
};

/// Simulates run number `run` at a noise level and runs every method on it. Runs of equal
/// number share their random numbers over all levels.
/// @throws InvalidInput for a method without that name
std::vector<MonteCarloErrors> run_monte_carlo(const MonteCarloStudySettings& settings,
                                              double noise_exponent, std::size_t run);

/// Reads settings; keys as in docs/studies.md, defaults as above.
/// @throws InvalidInput naming file, line and key
MonteCarloStudySettings read_monte_carlo_settings(const TomlTable& table);

/// The study: one work item per level and run. Rows: `method`, `noise_exponent`,
/// `robot_rotation_rmse_deg`, `object_rotation_rmse_deg`, `anees`, `relative_nees`, their
/// standard errors and 95 % chi-square bands, `runs`.
Study make_monte_carlo_study(const MonteCarloStudySettings& settings);

}  // namespace posemix
