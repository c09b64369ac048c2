// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/object_sensor.hpp"

namespace posemix {

namespace internal {
struct MultiObjectState;
}

/// Settings of MultiObjectFilter. A distance given as a probability is a quantile of the chi-square
/// distribution with six degrees of freedom.
struct MultiObjectSettings {
  std::size_t max_hypotheses = 8;  ///< largest number of hypotheses of one object
  /// Of these, the number of places that are kept for the hypotheses of the best recent score, so
  /// that a young hypothesis is not dropped for its small weight.
  std::size_t protected_hypotheses = 3;
  /// A detection within this quantile of a hypothesis, under any noise component, is explained by
  /// that hypothesis. A detection that no hypothesis explains starts one.
  double explained_probability = 0.9997;
  /// Factor on the detector's covariance in the covariance of a new hypothesis.
  double birth_covariance_factor = 9.0;
  double birth_score = 10.0;  ///< score of a new hypothesis [nats]
  double score_memory = 0.9;  ///< factor on the old score at every detection
  /// Hypotheses are merged (midway-merge paper, eq. 12 to 19) when their poses differ by less than
  /// this angle and this distance and lie within this quantile of each other, seen from the camera.
  double merge_rotation_rad = 1.0471975511965976;  ///< 60 deg
  double merge_translation_m = 0.5;
  double merge_probability = 0.94;
  /// A hypothesis becomes the leading one when its log weight is larger by more than this [nats].
  double leader_margin = 0.7;
  /// Whether the camera has odometry. Without odometry the camera's motion is estimated from
  /// differences of successive detections, in which errors that last for several frames cancel. The
  /// gain is then computed with the covariance of the likelihood, not with the update covariance,
  /// and reported covariances are not multiplied by the correlation length.
  bool has_odometry = true;
  /// The fraction of the odometry's covariance that is added to the camera. The rest is added to
  /// every object as a drift of the map. At 1 objects stand still and detections correct the camera
  /// fully; at 0 the camera follows its odometry.
  double odometry_camera_fraction = 0.1;
  /// The scale of a detector's noise is learned from innovations. The noise as given, scale one,
  /// counts as this many detections; at infinity nothing is learned.
  double noise_scale_detections = 10.0;
  double least_noise_scale = 0.1;  ///< the learned scale lies between this and one
  /// Expected duration of a detector's error [s]: detections of one object within this time carry
  /// about as much information as one. The correlation length is learned from innovations, and its
  /// expected value, this time over the time between detections, counts as so many detections.
  double correlation_s = 10.0;
  double correlation_detections = 300.0;
  /// The fraction of the noise's variance that is a bias, common to all detections of an object. It
  /// does not become smaller with more detections, and is added to the reported covariance.
  double bias_variance_fraction = 0.4;
  /// A detector stays with one mode, right or wrong, for longer than its errors are correlated. In
  /// mode_probability() the correlation length is multiplied by this factor.
  double mode_correlation_factor = 3.0;
  /// Factor on a detection's covariance in the gain of the camera, which weakens the correction of
  /// the camera. At infinity detections do not move the camera (Schmidt-Kalman filter).
  double camera_gain_noise = 1.0;
};

/// One hypothesis for the pose of one object, X = Exp(xi) X0 in the world frame. Covariances are
/// those of the true error, see MultiObjectFilter::camera().
struct ObjectHypothesis {
  SE3d pose;                  ///< T_world_object
  Matrix6d covariance;        ///< Cov(xi_O)
  Matrix6d cross_covariance;  ///< Cov(xi_O, xi_C), rows of the object
  /// Log of the weight among the hypotheses of the object and its absence, normalised. It counts
  /// every detection as independent and is certain too soon.
  double log_weight = 0.0;
  double probability = 0.0;  ///< the weight with dependent detections counted once
  /// Log evidence of recent detections relative to clutter, forgotten exponentially [nats].
  double score = 0.0;
  std::uint64_t id = 0;  ///< constant over time; a merge keeps the id of the heavier hypothesis
  std::uint64_t detections = 0;  ///< number of detections since its birth
};

/// The result of one detection.
struct ObjectUpdateReport {
  bool started = false;         ///< whether the detection started a hypothesis
  bool changed_leader = false;  ///< whether another hypothesis leads than before
  double log_evidence = 0.0;    ///< log density of the detection given all before [nats]
  std::size_t merges = 0;       ///< number of merges of hypotheses
  /// Probability, under the leading hypothesis, that the detection is from the noise's first
  /// component.
  double inlier_probability = 0.0;
  double clutter_probability = 1.0;  ///< probability of clutter under the leading hypothesis
  /// Residual from the leading hypothesis in standard deviations, along the axes of the noise.
  Vector6d residual = Vector6d::Zero();
};

/// Object SLAM with many hypotheses per object, but none for their combinations
/// (docs/many-objects.md). The posterior has the form
///   N(camera, leading hypotheses) prod_j sum_h w_jh p(O_jh | camera),
/// in which hypotheses of different objects are independent given the camera. After every detection
/// the filter projects the posterior onto this form with the least loss. A detection that no
/// hypothesis explains starts one. The cost is linear in the hypotheses; in the objects it is
/// quadratic per detection, and cubic while modes compete.
///
/// Invariants: covariances are symmetric positive definite; the weights of an object's hypotheses
/// and of its absence sum to one; every object with hypotheses has one that leads.
///
/// Predictions and updates throw InvalidInput, and change nothing, when an argument is not finite,
/// a variance or a time step negative. All that takes the index of an object or of a hypothesis
/// throws InvalidInput when there is none at it.
class MultiObjectFilter {
 public:
  /// @throws InvalidInput when a setting is out of range
  MultiObjectFilter(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectSensor> objects,
                    const MultiObjectSettings& settings);
  MultiObjectFilter(const MultiObjectFilter&);
  MultiObjectFilter(MultiObjectFilter&&) noexcept;
  MultiObjectFilter& operator=(const MultiObjectFilter&);
  MultiObjectFilter& operator=(MultiObjectFilter&&) noexcept;
  ~MultiObjectFilter();

  /// Odometry over `dt` seconds: T_C <- T_C motion. `q` is the covariance of the step's noise
  /// (right perturbation, camera frame).
  void predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt);

  /// Random walk, or a frame without odometry: the mean stays, and the camera gets all of the noise
  /// `q`.
  void predict_random_walk(const Matrix6d& q, double dt);

  /// Constant velocity, see posemix::predict_constant_velocity. The first call appends the camera's
  /// motion per reference period to the state, at rest with the covariance `at_rest`.
  void predict_constant_velocity(double periods, const Matrix6d& q, const Matrix6d& q_motion,
                                 const Matrix6d& at_rest, double dt);

  /// One detection T_camera_object of the object at `object`.
  /// @throws InvalidInput also when the pose is not finite
  ObjectUpdateReport update(std::size_t object, const SE3d& camera_object);

  /// The object becomes one that was never detected: it has no hypotheses, its absence is certain,
  /// and its noise is as given. The camera and the other objects stay as they are. In the joint
  /// Gaussian the poses behind that of the object move up by one.
  void forget(std::size_t object);

  /// Number of objects.
  std::size_t objects() const;
  /// Number of detections of an object that count as one, a mean over all objects.
  double correlation_length() const;
  /// Learned factors on the standard deviations of an object's noise, along its axes.
  Vector6d noise_scale(std::size_t object) const;
  /// T_world_camera. Covariances here and below are those of the true error: the filter's own times
  /// covariance_factor(), and for objects plus bias_covariance().
  ConcentratedGaussian<SE3d> camera() const;
  /// The hypotheses of an object; empty until it was seen.
  std::vector<ObjectHypothesis> hypotheses(std::size_t object) const;
  /// Index of the leading hypothesis.
  std::optional<std::size_t> leading(std::size_t object) const;
  /// Probability that the leading hypothesis is the right one: w^(1 / n), normalised over the
  /// hypotheses and absence, where n = mode_correlation_factor correlation_length() detections
  /// count as one.
  double mode_probability(std::size_t object) const;
  /// Log probability that no detection so far was the object [nats].
  double log_absent(std::size_t object) const;
  /// T_camera_object of one hypothesis. Its covariance takes the cross-covariance with the camera
  /// into account.
  ConcentratedGaussian<SE3d> relative(std::size_t object, std::size_t hypothesis) const;
  /// The joint Gaussian of the camera (pose 0) and the leading hypotheses of all objects that have
  /// any, in the order in which they were first detected, and of the camera's motion where that is
  /// part of the state.
  ConcentratedGaussian<PoseStackd> joint() const;
  /// The joint Gaussian of the camera, its motion where that is part of the state, and the given
  /// hypothesis of every object (an index of hypotheses(); objects without one are left out), with
  /// the filter's own covariances: neither covariance_factor() nor bias_covariance() is applied.
  /// @throws InvalidInput also when the number of hypotheses is not that of the objects
  ConcentratedGaussian<PoseStackd> joint_of(
      std::span<const std::optional<std::size_t>> hypotheses) const;
  /// Index of an object's pose in joint().
  std::optional<std::size_t> pose_index(std::size_t object) const;

  // --- for a smoother

  const MultiObjectSettings& settings() const;
  /// The sensor of an object with the scale of its noise as learned by now.
  const ObjectSensor& sensor(std::size_t object) const;
  /// The factor from the filter's own covariances, which count every detection as independent, to
  /// those of the true error.
  double covariance_factor() const;
  /// The covariance, in the world frame, of the error that all detections of an object at `pose`
  /// have in common when they are made from `camera`.
  Matrix6d bias_covariance(std::size_t object, const SE3d& camera, const SE3d& pose) const;

 private:
  std::unique_ptr<internal::MultiObjectState> state_;
};

}  // namespace posemix
