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

#include "posemix/base/range.hpp"
#include "posemix/base/units.hpp"
#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/sequence.hpp"
#include "posemix/slam/simulation_motion.hpp"
#include "posemix/slam/simulation_view.hpp"

/// Simulated recordings: a camera that goes around a table of objects that stand still, move, come
/// and go, odometry that drifts, and a detector that errs as real ones do. The world's z axis
/// points up.
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

/// The camera's path: an orbit around the target, looking at it, that ends where it began. A still
/// camera stays where it begins.
struct SimulationPath {
  std::size_t frames = 600;
  double period_s = 0.1;                               ///< between two frames; whole nanoseconds
  std::size_t turns = 1;                               ///< around the target over the recording
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  ///< world frame
  SimulationSwing range{1.0, 0.1, 3};                  ///< distance of the camera from the target
  SimulationSwing height{0.5, 0.1, 2};                 ///< of the camera above the target
  SimulationSetUp set_up = SimulationSetUp::moving;
  /// Error of the poses of a camera on an arm, drawn anew for every image: T_world_camera Exp(n).
  SimulationSd arm{Eigen::Vector3d::Constant(radians(0.1)), Eigen::Vector3d::Constant(1e-3)};
  /// The image; empty: the camera sees everything.
  std::optional<SimulationView> view;
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

/// An object, and the detector's errors on it. In a frame, a miss goes before an outlier and an
/// outlier before a flip. It stands still but for its motions, which follow each other in time:
/// each begins where the one before has left the object.
struct SimulationObject {
  std::string id;
  /// The detector tells the class and not which object it is; empty: it names the object.
  std::string class_id;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();    ///< of T_world_object at first
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
  double appears_s = 0.0;         ///< the object is there from this time on ...
  double removed_s = std::numeric_limits<double>::infinity();  ///< ... and until this one
  std::vector<SimulationConveyor> conveyor = {};
  std::vector<SimulationHandHeld> hand_held = {};
  std::vector<SimulationPickAndPlace> pick_and_place = {};
  std::vector<SimulationPutDown> put_down = {};
  std::vector<SimulationHeld> held = {};
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
  std::vector<SimulationFrame> frames;  ///< that may hold objects
  std::vector<SimulationClutter> clutter;
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
  SimulatedPose world_truth;                             ///< T_world_object at the first frame
  std::vector<SimulatedPose> relative_truth;             ///< T_camera_object
  std::vector<std::optional<SimulatedPose>> detections;  ///< of T_camera_object
  std::string class_id = {};                             ///< what its detections name in its place
  /// T_world_object by frame, where an object is not there the last one; no entries for one that
  /// stands still.
  std::vector<SimulatedPose> world_path = {};
  /// By frame, whether the object is there; no entries for one that always is.
  std::vector<bool> present = {};

  /// @throws InvalidInput when there is no such frame; `world_at`, too
  bool is_present(std::size_t frame) const {
    if (present.empty()) return true;
    internal::check_index(frame, present.size(), "frame");
    return present[frame];
  }
  const SimulatedPose& world_at(std::size_t frame) const {
    if (world_path.empty()) return world_truth;
    internal::check_index(frame, world_path.size(), "frame");
    return world_path[frame];
  }
};

/// A frame that may hold objects.
struct SimulatedFrame {
  std::string name;
  std::vector<SimulatedPose> truth;  ///< T_world_frame
  std::vector<SimulatedPose> given;  ///< T_world_frame as a filter is told
  SimulationSd error;  ///< of these, about and along the world's axes at the frame's origin
};

/// A detection in an image, where detections name classes or may be false.
struct SimulatedSighting {
  std::string object;  ///< that it names; empty where it names the class
  std::string class_id;
  SimulatedPose pose;                 ///< of T_camera_object
  std::optional<std::size_t> source;  ///< index of the true object; empty: it is false
};

/// A simulated recording. Vectors over frames have one entry per stamp.
struct SimulatedSequence {
  std::vector<std::int64_t> stamps_ns;      ///< nanoseconds from zero
  std::vector<SimulatedPose> odometry;      ///< T_odom_camera, the identity at first
  std::vector<SimulatedPose> camera_truth;  ///< T_world_camera
  SimulatedPose camera_start;  ///< T_world_camera of the first frame as the filter is told
  std::vector<SimulatedObject> objects;
  std::vector<SimulatedFrame> frames = {};
  /// Where any object has a class or there is clutter: all detections by frame, in the order of
  /// their numbers, which tells nothing of their sources. No entries otherwise.
  std::vector<std::vector<SimulatedSighting>> sightings = {};

  /// The recording as object SLAM takes it. Of objects that have a class neither detections nor
  /// truth are part of it: which instance follows which of them is not known before.
  /// @throws InvalidInput as validate
  Sequence sequence() const;
};

/// @throws InvalidInput naming a vector over frames without one entry per stamp, a pose of which a
/// coordinate is beyond kFarthestPosition or the quaternion is zero, a detection of an object that
/// is not there, or an object with a class where there are no sightings
void validate(const SimulatedSequence& simulated);

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

/// The error of the camera's motion that the filter is told: the claimed or the true error of the
/// odometry per square root of a second, or of a camera on an arm the error of its poses.
SimulationSd claimed_camera_error(const SimulationConfig& config);

/// The error of the start that the filter is told, on the left: `start`, or for a camera on an arm
/// that of its first pose.
SimulationSd claimed_start(const SimulationConfig& config, const SimulatedSequence& simulated);

/// The models of motion that the filter is told for an object, with the rates at which it changes
/// between them: derived from its motions, and for a class from the first of its objects that
/// moves.
MotionModels claimed_motion(const SimulationConfig& config, const SimulationObject& object);

/// The clutter that the filter is told for an object of a configuration: claimed_clutter, and false
/// detections of it per image, or for a class per image and object.
Clutter claimed_clutter_of(const SimulationConfig& config, const SimulationObject& object);

/// The models of all objects, with their motion and clutter.
std::vector<ObjectModel> object_models(const SimulationConfig& config);

/// What the filter is told: object model without motion, motion of the camera with the claimed
/// error, and start.
ObjectModel object_model(const SimulationObject& object);
MotionSettings motion_settings(const SimulationConfig& config);
ConcentratedGaussian<SE3d> camera_prior(const SimulationConfig& config,
                                        const SimulatedSequence& simulated);

}  // namespace posemix
