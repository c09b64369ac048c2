// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "posemix/base/state_fields.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/filter/object_motion.hpp"
#include "posemix/filter/object_prior.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix {

namespace internal {
class GlobalHypotheses;
struct MultiObjectState;
}  // namespace internal

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
  /// Weight of clutter for a noise model without clutter. At zero the model stays without: no
  /// detection starts a hypothesis but the first, and the first has probability one.
  double default_clutter = 0.05;
  double birth_score = 10.0;  ///< score of a new hypothesis [nats]
  double score_memory = 0.9;  ///< factor on the old score at every detection
  /// Hypotheses are merged (midway-merge paper, eq. 12 to 19) when their poses differ by less than
  /// this angle and this distance and lie within this quantile of each other, seen from the camera.
  double merge_rotation_rad = 1.0471975511965976;  ///< 60 deg
  double merge_translation_m = 0.5;
  double merge_probability = 0.94;
  /// A hypothesis becomes the leading one when its log probability is larger by more than this
  /// [nats].
  double leader_margin = 0.2;
  /// Where hypotheses of an object that can still win place the camera so differently that one
  /// camera for all would lose more than this [nats], the state is split into global hypotheses,
  /// each with its own camera, as long as there are fewer than `max_global_hypotheses`.
  double split_loss = 0.002;
  std::size_t max_global_hypotheses = 4;  ///< largest number of them; with one nothing is split
  /// Whether the camera has odometry. Without it detections correct the camera with the full gain.
  bool has_odometry = true;
  /// The scale of a detector's noise is learned from innovations. The noise as given, scale one,
  /// counts as this many detections; at infinity nothing is learned.
  double noise_scale_detections = 3.0;
  double least_noise_scale = 0.1;  ///< the learned scale lies between this and one
  /// Least factor on the gain with which a detection of one object moves the camera and the other
  /// objects, where the camera has odometry and the noise of the detector is a typical one
  /// (NoiseDependence::is_typical); it rises to one where the predicted pose is far less certain
  /// than the detection. Below one, errors that the model does not hold do less harm to
  /// the map; the covariance is that of the smaller gain (Joseph's form). At zero no detection, of
  /// whatever detector, moves the camera (Schmidt-Kalman filter).
  double camera_gain = 0.2;
  /// Factor on the gain with which a detection moves the slow error of its detector, in the same
  /// case. Slow error and object are told apart by how the axes of the noise turn against the
  /// object alone, which errors that the model does not hold spoil first; at zero the object stays
  /// among its detections, and only the covariance knows of the slow error.
  double slow_error_gain = 0.3;
  /// The parts of a correction's rotation and translation, about the camera, that the camera keeps,
  /// in the same case. The rest is taken back by a shift of the world, after which camera and
  /// objects are as before relative to each other: the map then follows the odometry more than the
  /// odometry the map.
  double camera_rotation_correction = 0.015;
  double camera_position_correction = 0.0;
};

/// One hypothesis for the pose of one object, X = Exp(xi) X0 in the world frame.
struct ObjectHypothesis {
  SE3d pose;                  ///< T_world_object
  Matrix6d covariance;        ///< Cov(xi_O)
  Matrix6d cross_covariance;  ///< Cov(xi_O, xi_C), rows of the object
  /// Log of the weight among the hypotheses of the object and its absence, normalised. It counts
  /// every detection as independent and is certain too soon.
  double log_weight = 0.0;
  double probability = 0.0;  ///< the weight with dependent detections counted once (mode_time_s)
  /// Log evidence of recent detections relative to clutter, forgotten exponentially [nats].
  double score = 0.0;
  std::uint64_t id = 0;  ///< constant over time; a merge keeps the id of the heavier hypothesis
  std::uint64_t detections = 0;  ///< number of detections since its birth
};

/// A hypothesis of an object without its covariance.
struct HypothesisMean {
  SE3d pose;  ///< T_world_object
  double probability = 0.0;
  std::uint64_t id = 0;
};

/// The leading hypothesis of an object.
struct LeadingEstimate {
  ConcentratedGaussian<SE3d> world;     ///< T_world_object
  ConcentratedGaussian<SE3d> relative;  ///< T_camera_object, with the cross-covariance
};

/// Poses X = Exp(xi) X0 and slow errors b = b0 + beta with their joint Gaussian.
struct JointState {
  PoseStackd poses;
  Eigen::VectorXd slow;        ///< b0 of the objects whose detectors have a slow error, in order
  Eigen::MatrixXd covariance;  ///< of [xi; beta]: xi in the world frame, beta in that of the noise
};

/// Where an observation comes from.
struct ObservationSource {
  /// T_body_camera. With several cameras, what is called the camera elsewhere is the body that
  /// carries them.
  SE3d body_camera = {};
  /// In place of `body_camera`, a camera whose pose on the body is estimated, by its index
  /// (MultiObjectFilter::add_camera).
  std::optional<std::size_t> camera = {};
  /// Zero for ObjectSensor::noise, n for the n-th of ObjectSensor::other_detectors.
  std::size_t detector = 0;
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
  /// z^T S^-1 z of the leading hypothesis under the noise's first component, of six degrees of
  /// freedom (fewer with symmetries about axes); none without a hypothesis before the detection.
  std::optional<double> nis = {};
  /// Residual from the leading hypothesis in standard deviations, along the axes of the noise.
  Vector6d residual = Vector6d::Zero();
};

/// Object SLAM with many hypotheses per object, and few for their combinations
/// (docs/many-objects.md). The posterior has the form
///   N(camera, leading hypotheses) prod_j sum_h w_jh p(O_jh | camera),
/// in which every pose O comes with the slow error of its detector, and hypotheses of different
/// objects are independent given the camera. After every detection the filter projects the
/// posterior onto this form with the least loss; while that would lose much, it is a mixture of few
/// such densities, global hypotheses, and what is reported is their projection. A detection that no
/// hypothesis explains starts one. The cost of a detection is linear in the hypotheses and, for
/// objects that were seen lately, in the objects; all others cost what is quadratic in the objects,
/// for many of them at once. Memory is quadratic in the objects.
///
/// Invariants: covariances are symmetric positive definite; the weights of an object's hypotheses
/// and of its absence sum to one; every object with hypotheses has one that leads.
///
/// The origin of the world may be anywhere: all is computed near the camera. Where a pose becomes
/// known 3e6 times worse than a detector sees it covariances are finite, and nothing else is
/// promised (docs/filter-consistency.md, "Definite, or finite").
///
/// All functions throw InvalidInput, and change nothing, as check_pose for a pose, as check_noise
/// for a noise, for a density so far from the origin that rounding leaves nothing of its
/// covariance, and for a time step that is negative or beyond kLatestStamp. All that takes the
/// index of an object or of a hypothesis throws InvalidInput when there is none at it.
class MultiObjectFilter {
 public:
  /// @throws InvalidInput when a setting is out of range, as check_pose and check_variances for the
  /// camera, and when the standard deviation of the camera, or of a slow error or component of a
  /// detector's noise, is more than 3e6 times that of a component
  MultiObjectFilter(const ConcentratedGaussian<SE3d>& camera,
                    const std::vector<ObjectSensor>& objects, const MultiObjectSettings& settings);
  MultiObjectFilter(const MultiObjectFilter&);
  MultiObjectFilter(MultiObjectFilter&&) noexcept;
  MultiObjectFilter& operator=(const MultiObjectFilter&);
  MultiObjectFilter& operator=(MultiObjectFilter&&) noexcept;
  ~MultiObjectFilter();

  /// Odometry over `dt` seconds: T_C <- T_C motion. `q` is the covariance of the step's noise
  /// (right perturbation, camera frame). Less of it is taken, as in the other predictions and of a
  /// camera that is given, where the camera's position would have a standard deviation of more than
  /// 1e7 times the smallest one of a detector's noise (100 m at least), or its rotation one of more
  /// than 100 rad.
  void predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt);

  /// Random walk, or a frame without odometry: the mean stays, and the camera gets all of the noise
  /// `q`. A camera whose rotation is then less certain than a uniform one is lost: its pose becomes
  /// independent of all else, with that rotation ("A camera that is lost").
  void predict_random_walk(const Matrix6d& q, double dt);

  /// Constant velocity, see posemix::predict_constant_velocity. The first call appends the camera's
  /// motion per reference period to the state, at rest with the covariance `at_rest`.
  void predict_constant_velocity(double periods, const Matrix6d& q, const Matrix6d& q_motion,
                                 const Matrix6d& at_rest, double dt);

  /// A camera whose pose is known from elsewhere, as on an arm whose encoders are read: after `dt`
  /// seconds it has this density, T_world_camera, whose error is independent of everything before
  /// (docs/many-objects.md, "A camera that is given"). From then on no correction is taken back by
  /// a shift of the world, in which the camera is given.
  void set_camera(const ConcentratedGaussian<SE3d>& world_camera, double dt);

  /// One detection T_camera_object of the object at `object`.
  ObjectUpdateReport update(std::size_t object, const SE3d& camera_object);

  /// One observation of the object at `object`, a mixture of poses (docs/many-objects.md,
  /// "Observations that are mixtures"). Its names and stamp are not looked at.
  /// @throws InvalidInput also as validate(observation), and for a camera or a detector that there
  /// is not
  ObjectUpdateReport update(std::size_t object, const Observation& observation,
                            const ObservationSource& source = {});
  /// A camera on the body whose pose T_body_camera is not known exactly: it becomes a part of the
  /// state, with its covariance with everything else, and every observation of the camera corrects
  /// it (docs/many-objects.md, "Cameras of a rig"). Returns its index.
  /// @throws InvalidInput also after the first detection, or the first prediction with constant
  /// velocity
  std::size_t add_camera(const ConcentratedGaussian<SE3d>& body_camera);

  /// One more object, never detected. Returns its index. With a prior it has one hypothesis from
  /// the beginning, which is as any other. With a motion it is put down elsewhere now and then
  /// (docs/many-objects.md, "Objects that are put down elsewhere"); a rate of zero is none.
  /// @throws InvalidInput as check_pose and check_variances for the prior, when it is 3e6 times as
  /// wide as a noise or its probability is not in (0, 1], for a noise as the constructor, and as
  /// validate(motion)
  std::size_t add_object(ObjectSensor object, const std::optional<ObjectPrior>& prior = {},
                         const std::optional<PutDownMotion>& motion = {});

  /// The object becomes one that was never detected: it has no hypotheses, its absence is certain,
  /// and its noise is as given. The camera and the other objects stay as they are. In the joint
  /// Gaussian the poses behind that of the object move up by one.
  void forget(std::size_t object);

  /// Number of objects.
  std::size_t object_count() const;
  /// Learned factors on the standard deviations of an object's noise, along its axes.
  Vector6d noise_scale(std::size_t object) const;
  /// T_world_camera. This and all that is reported below are marginals of one posterior; for
  /// objects they hold the error in common of their detections and any angle about an axis of
  /// symmetry.
  ConcentratedGaussian<SE3d> camera() const;
  /// The density of the camera, with a component for each global hypothesis; camera() has its
  /// moments.
  Mixture<ConcentratedGaussian<SE3d>> camera_mixture() const;
  /// The density of an object in the world given that it was detected, with a component for each of
  /// its hypotheses under each global hypothesis.
  /// @throws InvalidInput also when the object has no hypothesis
  Mixture<ConcentratedGaussian<SE3d>> object_mixture(std::size_t object) const;
  /// The hypotheses of an object; empty until it was seen.
  std::vector<ObjectHypothesis> hypotheses(std::size_t object) const;
  /// The same without covariances, which cost most.
  std::vector<HypothesisMean> hypothesis_means(std::size_t object) const;
  /// Index of the leading hypothesis.
  std::optional<std::size_t> leading(std::size_t object) const;
  /// Probability of the leading hypothesis, with dependent detections counted once.
  double mode_probability(std::size_t object) const;
  /// Log probability that no detection so far was the object, or that it was put down elsewhere
  /// and not seen there [nats].
  double log_absent(std::size_t object) const;
  /// T_camera_object of one hypothesis. Its covariance takes the cross-covariance with the camera
  /// into account.
  ConcentratedGaussian<SE3d> relative(std::size_t object, std::size_t hypothesis) const;
  /// T_camera_object as the detector sees it under one hypothesis, from a camera at T_body_camera:
  /// with the slow error of its detections, and without their white error.
  ConcentratedGaussian<SE3d> predicted_detection(std::size_t object, std::size_t hypothesis,
                                                 const SE3d& body_camera = {}) const;
  /// The same from the camera of `source`.
  /// @throws InvalidInput also for a camera that there is not
  ConcentratedGaussian<SE3d> predicted_detection(std::size_t object, std::size_t hypothesis,
                                                 const ObservationSource& source) const;
  /// Number of cameras whose pose on the body is estimated.
  std::size_t extrinsic_count() const;
  /// T_body_camera of such a camera as it is known by now, perturbed on the left in the frame of
  /// the body.
  /// @throws InvalidInput when there is none at the index
  ConcentratedGaussian<SE3d> extrinsic(std::size_t camera) const;
  /// The joint Gaussian of the camera (pose 0) and the leading hypotheses of all objects that have
  /// any, at pose_index(), and of the camera's motion where that is part of the state.
  ConcentratedGaussian<PoseStackd> joint() const;
  /// The same without a copy. The reference holds until the next prediction or update.
  const ConcentratedGaussian<PoseStackd>& current_joint() const;
  /// Whether the object has a hypothesis.
  bool is_known(std::size_t object) const;
  /// The leading hypothesis of every object, empty for those that have none: the marginals of
  /// joint() without joint() itself, linear in the objects.
  std::vector<std::optional<LeadingEstimate>> leading_estimates() const;
  /// The joint Gaussian of the camera, its motion where that is part of the state, and the given
  /// hypothesis of every object (an index of hypotheses(); objects without one are left out).
  /// @throws InvalidInput also when the number of hypotheses is not that of the objects
  ConcentratedGaussian<PoseStackd> joint_of(
      std::span<const std::optional<std::size_t>> hypotheses) const;
  /// Index of an object's pose in joint().
  std::optional<std::size_t> pose_index(std::size_t object) const;

  // --- for a smoother

  /// The Gaussian of the poses of joint_of() and of the slow errors of their objects. It holds what
  /// the filter estimates: not the errors in common of detections, and of angles about axes of
  /// symmetry only the one that stands for all.
  /// @throws InvalidInput as joint_of
  JointState joint_state(std::span<const std::optional<std::size_t>> hypotheses) const;
  /// The same with the slow error of every one of `cameras`, in their order, for each object whose
  /// detector has one; joint_state() has that of the camera that saw the object last.
  /// @throws InvalidInput as joint_of, and for a camera that there is not
  JointState joint_state(std::span<const std::optional<std::size_t>> hypotheses,
                         std::span<const ObservationSource> cameras) const;
  /// What is reported of an object at `pose` in addition to what is estimated, world frame.
  Matrix6d unseen_covariance(std::size_t object, const SE3d& pose) const;
  /// The reference holds until the next prediction or update.
  const MultiObjectSettings& settings() const;
  /// The sensor of an object with the scale of its noise as learned by now. The reference holds
  /// until the next prediction or update.
  /// @throws InvalidInput also for a detector that the object does not have
  const ObjectSensor& sensor(std::size_t object, std::size_t detector = 0) const;

 private:
  template <class>
  friend struct internal::StateFields;

  /// @throws InvalidInput for a filter that was moved from
  internal::GlobalHypotheses& hypotheses_of_all();
  const internal::GlobalHypotheses& hypotheses_of_all() const;
  const internal::MultiObjectState& current() const;

  std::unique_ptr<internal::GlobalHypotheses> state_;
};

}  // namespace posemix
