// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>

#include "detection_update.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/filter/multi_object_filter.hpp"

namespace posemix::internal {

/// Log ratio of the two largest weights; zero for one component.
double clarity(std::span<const ObservationComponent> components);

/// The part of an innovation's variance that is the detector's where it tells of
/// the detector. Less of it tells of the camera's motion, which may be quieter than it is said to
/// be: what was learned where a camera stands, with the noise of a random walk, went to zero in the
/// long run.
inline constexpr double kLeastDetectorPart = 1.0 / 6.0;

/// The detector of one object: its noise as given, and the scale of the noise that is learned from
/// the innovations of the leading hypothesis (docs/many-objects.md, "The scale of the noise").
class LearnedSensor {
 public:
  explicit LearnedSensor(ObjectSensor sensor);

  /// The sensor with the scale of its noise as learned by now.
  const ObjectSensor& sensor() const { return sensor_; }
  /// Covariance of the error in common. That of a noise that is only typical has the scale of the
  /// slow error; of one that is stated no detection tells.
  std::optional<Matrix6d> common_covariance() const;
  /// Number of detections.
  std::uint64_t detections() const { return detections_; }
  /// Time since the last detection [s].
  double seconds_since(double now_s) const { return now_s - last_s_; }
  /// The part of a detection at the time `now_s`, for the weights of hypotheses, that does not
  /// depend on the detection before: 1 - exp(-time between them / mode_time_s).
  double new_share(double now_s) const;
  /// The exponent with which the weights of an observation's components count at the time `now_s`:
  /// new_share, and all of what they say more clearly than those before.
  double weight_share(const Observation& observation, double now_s) const;
  /// Counts a detection at the time `now_s`. Returns its new_share.
  double count_detection(const WeighedObservation& observation, double now_s);
  /// The view of the object turned by a rotation vector [rad] (view_turn) within a time [s].
  void look(const Eigen::Vector3d& turn, double dt) {
    turned_ += turn;
    looked_s_ += dt;
  }
  /// Learns the scale of the noise from an innovation of an observation that brings its own
  /// covariances or not, of which `least_part` at least is the detector's. Returns the factors by
  /// which the scale of the slow error changed.
  Vector6d learn(const DetectionUpdate& update, bool has_covariance,
                 const MultiObjectSettings& settings, double least_part);
  /// Sets the scale of the slow error, which is one for all detectors of an object.
  void set_slow_scale(const Vector6d& scale) { sensor_.slow_scale = scale; }
  /// The sensor as it was given: no detections, nothing learned.
  void reset();

 private:
  template <class>
  friend struct StateFields;

  Vector6d learn_slow_scale();
  bool has_learned_wrong(const Innovation& inlier, const Matrix6d& s, const Vector6d& z,
                         double squared_distance);
  bool is_plausible_as_given(const Innovation& inlier, const Matrix6d& s, const Vector6d& z) const;

  ObjectSensor sensor_;
  Vector6d given_noise_scale_;
  Vector6d given_slow_scale_;
  Vector6d information_ = Vector6d::Zero();  ///< on the log variance, of the detections so far
  std::uint64_t detections_ = 0;
  double last_s_ = 0.0;  ///< time of the last detection
  /// Log ratio of the two largest weights of the observation that said most in the last mode time.
  double told_ = 0.0;
  Eigen::Vector3d turned_ = Eigen::Vector3d::Zero();  ///< of the view since learning began [rad]
  double looked_s_ = 0.0;                             ///< time since learning began [s]
  /// How much of a slow error as large as given would have shown by now: 0 nothing, 1 all.
  Vector6d shown_ = Vector6d::Zero();
  /// Number of detections in succession, unlike each other, that are inliers by the noise as given
  /// alone.
  std::uint64_t surprises_ = 0;
  Vector6d surprise_ = Vector6d::Zero();  ///< residual of the last of them
};

}  // namespace posemix::internal
