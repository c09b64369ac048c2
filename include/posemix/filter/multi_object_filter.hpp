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

/// Settings of MultiObjectFilter. Distances that are probabilities are quantiles of the chi-square
/// distribution with six degrees of freedom.
struct MultiObjectSettings {
  std::size_t max_hypotheses = 8;        ///< of one object
  std::size_t protected_hypotheses = 3;  ///< of these, those of the best recent score
  /// A detection within this quantile of a hypothesis, under any noise component, is explained by
  /// it; one that none explains starts a hypothesis.
  double explained_probability = 0.9997;
  double birth_covariance_factor = 9.0;  ///< of the detector's noise, for a new hypothesis
  double birth_score = 10.0;             ///< [nats]
  double score_memory = 0.9;             ///< share of the score that is left after a detection
  /// Hypotheses are merged (midway-merge paper, eq. 12 to 19) when their poses differ by less than
  /// these and lie within this quantile of each other as seen from the camera.
  double merge_rotation_rad = 1.0471975511965976;  ///< 60 deg
  double merge_translation_m = 0.5;
  double merge_probability = 0.94;
  double leader_margin = 0.7;  ///< a hypothesis takes the lead when it is ahead by more [nats]
  /// Whether the camera has odometry. Without it its motion is learned from differences of
  /// successive detections, in which their common errors cancel: detections then teach by the
  /// covariance that weighs them, and frames count as independent of each other.
  bool has_odometry = true;
  /// Share of the odometry's noise that is the camera's; the rest is the map's drift, every object
  /// for itself. At 1 objects stand still and their detections correct the camera as much as they
  /// can; at 0 the camera follows its odometry.
  double odometry_camera_fraction = 0.1;
  /// The noise's scale is learned from innovations, between the least scale and one; the noise as
  /// given counts as this many detections. Infinity: the noise is taken as given.
  double noise_scale_detections = 10.0;
  double least_noise_scale = 0.1;
  /// Errors of successive detections depend on each other: those within this time count as one.
  /// Learned from innovations, this value counting as that many detections.
  double correlation_s = 10.0;
  double correlation_detections = 300.0;
  /// Share of the noise's variance that all frames have in common, so that it never averages out.
  double bias_variance_fraction = 0.4;
  /// Runs of one answer, right or wrong, are longer than errors depend on each other: in
  /// mode_probability so many times as many count as one.
  double mode_correlation_factor = 3.0;
  /// The noise with which the camera's gain is computed, in units of a detection's; infinity: the
  /// camera is considered, not estimated (Schmidt).
  double camera_gain_noise = 1.0;
};

/// One alternative for the pose of one object, X = Exp(xi) X0 in the world frame.
struct ObjectHypothesis {
  SE3d pose;                  ///< T_world_object
  Matrix6d covariance;        ///< of xi_O
  Matrix6d cross_covariance;  ///< Cov(xi_O, xi_C), rows of the object
  double log_weight = 0.0;    ///< among the hypotheses of the object and its absence, normalised;
                              ///< counts every detection as independent and is sure too soon
  double probability = 0.0;   ///< the same with dependent detections counted once
  double score = 0.0;         ///< recent log evidence over that of clutter [nats]
  std::uint64_t id = 0;       ///< kept over time; a merge keeps that of the heavier
  std::uint64_t detections = 0;  ///< processed since it began
};

/// What became of a detection.
struct ObjectUpdateReport {
  bool started = false;         ///< it began a hypothesis
  bool changed_leader = false;  ///< another hypothesis leads than before
  double log_evidence = 0.0;    ///< of the detection given all before [nats]
  std::size_t merges = 0;
  double inlier_probability = 0.0;  ///< probability that the leading hypothesis' first noise
                                    ///< component explains it
  double clutter_probability = 1.0;  ///< that nothing of the leading hypothesis does
  Vector6d residual =
      Vector6d::Zero();  ///< from the leading hypothesis, white under that component
};

/// Object SLAM with many hypotheses for every object and none for their product
/// (docs/many-objects.md): the posterior is
///   N(camera, leading hypotheses) prod_j sum_h w_jh p(O_jh | camera),
/// the hypotheses of different objects are independent given the camera, and an object's detection
/// is projected back onto this form with the least loss. A detection that no hypothesis explains
/// starts one. Cost: linear in hypotheses; in objects quadratic per detection, cubic while modes
/// compete.
///
/// Invariants: covariances are symmetric positive definite; the weights of an object's hypotheses
/// and of its absence sum to one; every object with hypotheses has one that leads.
///
/// Predictions and updates throw InvalidInput, and change nothing, when an argument is not finite,
/// a variance or a time step negative.
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

  /// Odometry over `dt` seconds: T_C <- T_C motion, with noise `q` of the step (right perturbation,
  /// camera frame).
  void predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt);

  /// Random walk, or a frame that the odometry lacks: the mean stays, q counts in full.
  void predict_random_walk(const Matrix6d& q, double dt);

  /// Constant velocity: the camera's motion per reference period becomes part of the state at the
  /// first call, at rest with covariance `at_rest`; else as posemix::predict_constant_velocity.
  void predict_constant_velocity(double periods, const Matrix6d& q, const Matrix6d& q_motion,
                                 const Matrix6d& at_rest, double dt);

  /// One detection T_camera_object of the object at `object`.
  /// @throws InvalidInput when there is no such object or the pose is not finite
  ObjectUpdateReport update(std::size_t object, const SE3d& camera_object);

  /// The object is as if never seen: no hypotheses, absence certain, its noise as given. What its
  /// detections said about the camera and about others stays. Indices of the joint Gaussian behind
  /// its own move up by one.
  /// @throws InvalidInput when there is no such object
  void forget(std::size_t object);

  std::size_t objects() const;
  /// Detections of an object that count as one, over all objects.
  double correlation_length() const;
  /// Factors of the standard deviations of an object's noise, learned.
  Vector6d noise_scale(std::size_t object) const;
  /// T_world_camera. Covariances here and below are of the true error: those of the filter times
  /// correlation_length(), and for objects the error that all frames have in common.
  ConcentratedGaussian<SE3d> camera() const;
  /// The hypotheses of an object; empty until it was seen.
  std::vector<ObjectHypothesis> hypotheses(std::size_t object) const;
  /// Index of the hypothesis that leads.
  std::optional<std::size_t> leading(std::size_t object) const;
  /// Probability that the leading hypothesis is the right one: its weight against those of the
  /// others and of absence, with dependent detections counted once, w^(1 / dependent).
  double mode_probability(std::size_t object) const;
  /// Log probability that nothing seen so far was the object.
  double log_absent(std::size_t object) const;
  /// T_camera_object of one hypothesis, with the cross-covariance.
  ConcentratedGaussian<SE3d> relative(std::size_t object, std::size_t hypothesis) const;
  /// Camera, then the leading hypotheses of the objects that have any, in the order in which they
  /// began (and the camera's motion, see pose_index).
  ConcentratedGaussian<PoseStackd> joint() const;
  std::optional<std::size_t> pose_index(std::size_t object) const;

  // --- what a smoother needs

  const MultiObjectSettings& settings() const;
  /// The sensor with the scale of its noise as it is learned by now.
  const ObjectSensor& sensor(std::size_t object) const;
  /// What the filter's own covariances are multiplied by to be those of the true error.
  double covariance_factor() const;
  /// The error that all detections of the object have in common, in the world frame.
  Matrix6d bias_covariance(std::size_t object, const SE3d& camera, const SE3d& pose) const;
  /// The camera, its motion where it has one, and the given hypothesis of every object (by index;
  /// objects with none are left out), with the filter's own covariances.
  ConcentratedGaussian<PoseStackd> joint_of(
      std::span<const std::optional<std::size_t>> hypotheses) const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace posemix
