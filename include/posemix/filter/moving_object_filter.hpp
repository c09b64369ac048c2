// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "posemix/base/state_fields.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"
#include "posemix/filter/motion_models.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix {

namespace internal {
class MovingObjectState;
}  // namespace internal

/// Settings of MovingObjectFilter. A distance given as a probability is a quantile of the
/// chi-square distribution with six degrees of freedom.
struct MovingObjectSettings {
  std::size_t max_hypotheses = 6;  ///< largest number of hypotheses for the place of the object
  /// A component of an observation within this quantile of a hypothesis is explained by it. One
  /// that none explains starts one.
  double explained_probability = 0.9997;
  /// Weight of clutter for a noise model without. It is positive: an object may always be
  /// elsewhere.
  double default_clutter = 0.05;
  /// The part of clutter that stands alone: wrong for one detection, after which the detector is as
  /// it was before. The rest comes in runs of mode_time_s, or of the noise's longest run_length.
  double isolated_clutter = 0.5;
  /// The part of runs that are at the place of another hypothesis, where there is one: what
  /// misleads a detector does so again.
  double recurring_clutter = 0.5;
  /// The part of clutter that is at the place of the object in any orientation, and tells its
  /// position; the rest is anywhere.
  double turned_clutter = 0.5;
  /// Rate at which the object is anywhere at once, whatever its model says [1/s]: carried away
  /// unseen, or moved in a way that no model describes.
  double lost_rate = 1e-3;
  /// Hypotheses are merged (midway-merge paper, eq. 12 to 19) when their poses differ by less than
  /// this angle and this distance and lie within this quantile of each other.
  double merge_rotation_rad = 1.0471975511965976;  ///< 60 deg
  double merge_translation_m = 0.5;
  double merge_probability = 0.94;
  /// The scale of the detector's noise is learned from innovations, as in MultiObjectSettings. The
  /// noise as given counts as this many detections; at infinity nothing is learned.
  double noise_scale_detections = 3.0;
  double least_noise_scale = 0.1;  ///< the learned scale lies between this and one
  /// Factor on the gain of the slow error where the noise is a typical one, as in
  /// MultiObjectSettings. What tells it from the pose is that the object stands still, so that it
  /// is only considered here.
  double slow_error_gain = 0.0;
};

/// A frame with a known pose: the camera, or a gripper or hand that may hold the object.
struct KnownFrame {
  SE3d pose = {};  ///< T_world_frame
  /// Covariance of the part of the pose's error that is drawn anew for every image (perturbation on
  /// the left, world frame); zero is exact.
  Matrix6d covariance = Matrix6d::Zero();
};

/// @throws InvalidInput as check_pose and check_noise
void validate(const KnownFrame& frame);

/// The camera of an observation. Its pose is not corrected (docs/moving-objects.md, "The camera").
struct KnownCamera {
  KnownFrame frame = {};  ///< T_world_camera
  /// Covariance of the part of the error that is the same for all images, as of a still camera
  /// whose place was measured once: perturbation on the left, world frame. No number of detections
  /// lowers it.
  Matrix6d constant_covariance = Matrix6d::Zero();
};

/// A camera whose pose is exact.
KnownCamera exact_camera(const SE3d& world_camera);
/// A camera that does not move, and whose pose has one error for good.
KnownCamera still_camera(const ConcentratedGaussian<SE3d>& world_camera);
/// A camera whose pose has an error that is drawn anew for every image, as on an arm or a mount
/// that shakes, next to a constant one of the covariance `constant`.
KnownCamera camera_on_arm(const ConcentratedGaussian<SE3d>& world_camera,
                          const Matrix6d& constant = Matrix6d::Zero());

/// One hypothesis for the place of the object.
struct MovingObjectHypothesis {
  ConcentratedGaussian<SE3d> world;  ///< T_world_object, over all models
  /// Twist along the world's axes: turning rate [rad/s] and velocity of the object's origin [m/s].
  Vector6d twist;
  Matrix6d twist_covariance;
  double probability;          ///< with the case that the place is not known, all sum to one
  std::vector<double> models;  ///< probability of each model given the hypothesis
  std::uint64_t id;            ///< constant over time; a merge keeps that of the more probable
  std::uint64_t detections;    ///< since its birth, the first included
};

/// The result of one observation.
struct MovingObjectReport {
  bool started = false;         ///< whether the observation started a hypothesis
  bool changed_leader = false;  ///< whether another hypothesis is the most probable
  std::size_t merges = 0;       ///< number of merges of hypotheses
  double log_evidence = 0.0;    ///< log density of the observation given all before [nats]
  /// Probability, under the leading hypothesis, that the detector saw the object: not clutter,
  /// alone or in a run. This and what follows is of a hypothesis that the observation split as it
  /// was as a whole, and nothing of one just begun.
  double right_probability = 0.0;
  /// Probability of the noise's first component under the leading hypothesis.
  double inlier_probability = 0.0;
  /// z^T S^-1 z of the leading hypothesis' most probable model, of six degrees of freedom (fewer
  /// with symmetries about axes), under the first component of the right mode that is most
  /// probable: that of a flip, where the noise has flips and the detection is one; none for a
  /// hypothesis just begun.
  std::optional<double> nis = {};
  /// Residual of the same in standard deviations, along the axes of the noise.
  Vector6d residual = Vector6d::Zero();
};

/// The object at a time.
struct MovingObjectEstimate {
  double time_s;
  std::vector<MovingObjectHypothesis> hypotheses;  ///< the most probable first
  double lost_probability;                         ///< that it is at none of them
  std::vector<double> models;                      ///< probability of each model
};

/// The pose of one object that moves, seen by a detector that errs: an interacting multiple model
/// filter (Blom and Bar-Shalom, 1988) times hypotheses for the place of the object and for what the
/// detector shows (docs/moving-objects.md).
///
/// The posterior is sum_hkm p_hkm N_hk over hypotheses h, motion models k and modes m of the
/// detector (right, right with an offset, or in a run of wrong detections at the place of another
/// hypothesis), and the case that the place is not known. All that is reported is a marginal of it.
///
/// Invariants: probabilities sum to one; covariances are symmetric positive semidefinite, and those
/// that are reported definite as soon as the object was seen; an observation that is refused
/// changes nothing.
class MovingObjectFilter {
 public:
  /// @throws InvalidInput when a setting, a model, a rate or a probability is out of range, sizes
  /// differ, the sensor has other detectors, or its slow error or one component of its noise is 3e6
  /// times as wide as another component
  explicit MovingObjectFilter(ObjectSensor sensor, MotionModels models = {},
                              const MovingObjectSettings& settings = {});
  MovingObjectFilter(const MovingObjectFilter&);
  MovingObjectFilter(MovingObjectFilter&&) noexcept;
  MovingObjectFilter& operator=(const MovingObjectFilter&);
  MovingObjectFilter& operator=(MovingObjectFilter&&) noexcept;
  ~MovingObjectFilter();

  /// Predicts to the observation's stamp, then takes it in. `frames` has the poses at that time of
  /// the frames that models name (AttachedMotion); its names are not looked at.
  /// @throws InvalidInput also as validate(observation), for a stamp before the last one, a
  /// covariance that is not positive semidefinite, and when a frame is missing
  MovingObjectReport update(const Observation& observation, const KnownCamera& camera,
                            const std::vector<KnownFrame>& frames = {});

  /// Predicts to a time without an observation.
  /// @throws InvalidInput for a time before the last one, and as update for the frames
  void predict(double time_s, const std::vector<KnownFrame>& frames = {});

  /// Number of observations so far.
  std::uint64_t observation_count() const;
  /// Time of the last update or prediction [s]; none before the first.
  std::optional<double> time_s() const;
  /// The object at time_s().
  /// @throws InvalidInput before the first observation
  MovingObjectEstimate estimate() const;
  /// The object at a later time, which changes nothing. Frames without a pose at that time stay
  /// where they are.
  /// @throws InvalidInput also as predict
  MovingObjectEstimate estimate_at(double time_s, const std::vector<KnownFrame>& frames = {}) const;

  /// The density of the object in the world given that its place is known: a component for every
  /// model of every hypothesis, with the constant error of the camera, the error in common of the
  /// detector, and any angle about an axis of symmetry.
  /// @throws InvalidInput when there is no hypothesis
  Mixture<ConcentratedGaussian<SE3d>> object_mixture() const;
  /// The same as seen from a camera whose stated pose is `camera`: T_camera_object. Of the errors
  /// of the camera it has that of one image, and not the constant one, which is no error here.
  Mixture<ConcentratedGaussian<SE3d>> relative_mixture(const KnownCamera& camera) const;
  /// T_camera_object at the most probable hypothesis, over all models, with the errors of
  /// relative_mixture.
  /// @throws InvalidInput as relative_mixture
  ConcentratedGaussian<SE3d> relative(const KnownCamera& camera) const;
  /// T_camera_object as the detector sees it at the most probable hypothesis: with the slow error
  /// of its detections, and without their white error.
  /// @throws InvalidInput as relative_mixture
  ConcentratedGaussian<SE3d> predicted_detection(const KnownCamera& camera) const;
  /// The world in which the camera's pose is stated has moved: every pose T of the object becomes
  /// `by` T, and its covariance grows by `added` (world frame); the constant error of the camera is
  /// from now on `constant`. For a camera that is estimated (docs/moving-objects.md).
  /// @throws InvalidInput for numbers that are not finite, and covariances that are not positive
  /// semidefinite
  void move_world(const SE3d& by, const Matrix6d& added, const Matrix6d& constant);
  /// object_mixture at a later time, without a change of the filter.
  Mixture<ConcentratedGaussian<SE3d>> predict_to(double time_s,
                                                 const std::vector<KnownFrame>& frames = {}) const;

  /// The sensor with the scale of its noise as learned by now.
  const ObjectSensor& sensor() const;
  const MotionModels& models() const;
  const MovingObjectSettings& settings() const;

 private:
  template <class>
  friend struct internal::StateFields;

  friend class MovingObjectSmoother;

  std::unique_ptr<internal::MovingObjectState> state_;
};

}  // namespace posemix
