// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/sequence.hpp"

/// Simulated recordings: a camera that goes around a table of objects, odometry that drifts, and a
/// detector that errs as real ones do. The world's z axis points up.
///
/// The same configuration and seed give the same recording on any machine: random numbers come from
/// counter-based streams, one for every purpose and object; everything is computed in long double;
/// and poses are rounded to whole billionths before they are used, so that the last bits in which
/// mathematical libraries differ do not show.
namespace posemix {

/// A length that swings: mean + swing sin(2 pi waves t), t from 0 to 1 over the recording.
struct SimulationSwing {
  double mean_m = 0.0;
  double swing_m = 0.0;
  std::size_t waves = 0;  ///< whole waves over the recording
};

/// The camera's path: an orbit around the target, looking at it, that ends where it began.
struct SimulationPath {
  std::size_t frames = 600;
  double period_s = 0.1;                               ///< between two frames; whole nanoseconds
  std::size_t turns = 1;                               ///< around the target over the recording
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  ///< world frame
  SimulationSwing range{1.0, 0.1, 3};                  ///< distance of the camera from the target
  SimulationSwing height{0.5, 0.1, 2};                 ///< of the camera above the target
};

/// Standard deviations of a pose error about and along x, y, z.
struct SimulationSd {
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
};

/// One component of the detector's error: NoiseComponent with a diagonal covariance. With
/// NoiseFrame::ray the standard deviations of the translation are fractions of the range.
struct SimulationNoise {
  double weight = 1.0;
  SimulationSd sd{Eigen::Vector3d::Constant(radians(4.0)), Eigen::Vector3d::Constant(5e-3)};
  NoiseFrame frame = NoiseFrame::object;
  Eigen::Vector3d offset_rotation_rad = Eigen::Vector3d::Zero();  ///< rotation vector
  Eigen::Vector3d offset_translation_m = Eigen::Vector3d::Zero();
};

/// The slow part of the detector's error (SlowError) with a diagonal covariance, along the axes and
/// in the units of the component that is drawn.
struct SimulationSlowError {
  SimulationSd sd;
  double correlation_s = std::numeric_limits<double>::infinity();
  double correlation_angle_rad = std::numeric_limits<double>::infinity();
};

/// A disturbance that comes in runs of frames: a two-state Markov chain.
struct SimulationRuns {
  double fraction = 0.0;    ///< of the frames that are disturbed, in [0, 1]
  double mean_run_s = 0.0;  ///< runs are at least as long as independent frames make them
};

/// Detections of a wrong mode of a near-symmetry, T_camera_object flip offset Exp(n).
struct SimulationFlips {
  SimulationRuns runs;
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  ///< rotation vector
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
};

/// Gross errors: for the length of a run, detections are T_camera_object wrong Exp(n), where the
/// rotation of `wrong` is uniform over SO(3) and its translation uniform in a box.
struct SimulationOutliers {
  SimulationRuns runs;
  Eigen::Vector3d box_m = Eigen::Vector3d::Constant(0.2);  ///< half the edges of the box
};

/// An object that stands on the table, and the detector's errors on it. In a frame, a miss goes
/// before an outlier and an outlier before a flip.
struct SimulationObject {
  std::string id;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();    ///< of T_world_object
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  ///< rotation vector of T_world_object
  std::vector<SimulationNoise> noise{SimulationNoise{}};
  /// Correlation time of the error: the component is kept with probability r = exp(-dt / time) and
  /// drawn anew otherwise, and n = L z with z_k = r z_(k-1) + sqrt(1 - r^2) w_k. At 0, frames are
  /// independent: without flips and outliers the detections follow DetectorNoise exactly.
  double correlation_s = 0.0;
  std::optional<SimulationSlowError> slow;  ///< added to the error of the components
  SimulationFlips flips;
  SimulationOutliers outliers;
  SimulationRuns misses;
  std::size_t hidden_frames = 0;  ///< the object appears after so many frames
  /// The noise that the filter is told; empty: claimed_noise derives it.
  std::vector<SimulationNoise> claimed;
};

/// What is simulated.
struct SimulationConfig {
  SimulationPath path;
  /// Odometry error per square root of a second, on the right: U Exp(w), camera frame.
  SimulationSd odometry{Eigen::Vector3d::Constant(radians(0.15)), Eigen::Vector3d::Constant(2e-3)};
  /// Odometry error that the filter is told; empty: the true one.
  std::optional<SimulationSd> claimed_odometry;
  /// Error of the start pose that the filter is told, on the left: world frame.
  SimulationSd start{Eigen::Vector3d::Constant(radians(0.05)), Eigen::Vector3d::Constant(2e-3)};
  std::vector<SimulationObject> objects;
};

/// A pose tx ty tz qx qy qz qw in whole billionths (of a metre, of one): the digits that files
/// show. The quaternion's last component that is not zero, from qw backwards, is positive.
struct SimulatedPose {
  std::array<std::int64_t, 7> billionths{};

  /// The pose that a reader of the digits gets, bit by bit.
  SE3d pose() const;
};

/// One object of a simulated recording.
struct SimulatedObject {
  std::string id;
  SimulatedPose world_truth;                             ///< T_world_object
  std::vector<SimulatedPose> relative_truth;             ///< T_camera_object
  std::vector<std::optional<SimulatedPose>> detections;  ///< of T_camera_object
};

/// A simulated recording. Vectors over frames have one entry per stamp.
struct SimulatedSequence {
  std::vector<std::int64_t> stamps_ns;      ///< nanoseconds from zero
  std::vector<SimulatedPose> odometry;      ///< T_odom_camera, the identity at first
  std::vector<SimulatedPose> camera_truth;  ///< T_world_camera
  SimulatedPose camera_start;  ///< T_world_camera of the first frame as the filter is told
  std::vector<SimulatedObject> objects;

  /// The recording as object SLAM takes it.
  Sequence sequence() const;
};

/// @throws InvalidInput naming the setting that is out of range
void validate(const SimulationConfig& config);

/// @throws InvalidInput as validate
SimulatedSequence simulate(const SimulationConfig& config, std::uint64_t seed);

/// The noise components that the filter is told for an object: `claimed`, or else the true ones,
/// each once more for the flips, weighted by their fraction. The part that claimed_slow_error
/// holds, outliers and misses are not part of it.
std::vector<SimulationNoise> claimed_noise(const SimulationObject& object);

/// The slow error that the filter is told: `slow`, with at least 1e-6 (rad, m) along every axis and
/// none where all deviations are zero; or for errors with a correlation time nine tenths of their
/// least variance, and none where the components have different frames.
std::optional<SimulationSlowError> claimed_slow_error(const SimulationObject& object);

/// The time for which the detector stays with a mode or with clutter, as the filter is told: the
/// longest of the runs of flips and of outliers and, for several components, the correlation time.
double claimed_mode_time_s(const SimulationObject& object);

/// The clutter that the filter is told beside components whose weights sum to one: the fraction of
/// outliers.
Clutter claimed_clutter(const SimulationObject& object);

/// What the filter is told: object model, motion with the claimed odometry error, and start.
ObjectModel object_model(const SimulationObject& object);
MotionSettings motion_settings(const SimulationConfig& config);
ConcentratedGaussian<SE3d> camera_prior(const SimulationConfig& config,
                                        const SimulatedSequence& simulated);

}  // namespace posemix
