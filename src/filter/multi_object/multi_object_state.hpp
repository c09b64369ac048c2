// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "noise_scale.hpp"
#include "object_belief.hpp"
#include "posemix/density/pose_stack.hpp"
#include "put_down.hpp"
#include "significant_motion.hpp"

namespace posemix::internal {

/// One object of a MultiObjectFilter.
struct TrackedObject {
  std::vector<LearnedSensor> detectors;
  /// How it is put down elsewhere; null for an object that is not.
  std::shared_ptr<const PutDown> put_down = {};
  ObjectBelief belief = {};
  std::uint64_t last_update = 0;  ///< number of the last detection of the object, from one

  /// Of the object's first detector: symmetries, slow error and error in common are the object's.
  const ObjectSensor& sensor() const { return detectors.front().sensor(); }
};

/// How many blocks of the joint Gaussian are active. The numbers are those of the least time.
struct ActiveLimits {
  std::size_t dense = 48;  ///< with so many blocks in all nothing becomes passive
  std::size_t most = 28;   ///< beyond, the objects that were not seen for longest become passive
  std::size_t kept = 8;    ///< so many blocks of objects stay active then
};

/// So much of the error of the world that is kept beside the joint Gaussian is left in it, which
/// is positive definite by that.
inline constexpr double kLeftOfWorld = 0.01;

/// An observation of one object as its hypotheses see it.
struct ObservedDetection {
  WeighedObservation observation;
  DetectionUpdates updates;    ///< by hypothesis
  GainFactors factors;         ///< of the updates
  KeptVector<bool> explained;  ///< by component, whether any hypothesis explains it
  double share = 1.0;          ///< of the detection that is new, for probabilities
  std::optional<PutDownEvidence> put_down = {};  ///< for an object that is put down elsewhere
};

/// Births of an object that is put down elsewhere.
struct BirthPlaces {
  std::size_t detector;
  std::vector<double> log_modes = {};  ///< by mode, the log weight of a birth at a component alone
  std::vector<std::uint64_t> places;   ///< of the components; births enter their own
};

/// Component `k` of an observation, and its other components, both without clutter: their evidence
/// is that of the parts.
std::pair<WeighedObservation, WeighedObservation> parted(const WeighedObservation& observation,
                                                         std::size_t k);

/// Of every component of an observation, whether it may start hypotheses.
using Starters = KeptVector<bool>;

/// The state under one global hypothesis, and its change by a detection.
struct MultiObjectState {
  MultiObjectState(const ConcentratedGaussian<SE3d>& camera,
                   const std::vector<ObjectSensor>& sensors, const MultiObjectSettings& settings);

  /// One observation of object `j`: how its hypotheses see it, which
  /// changes nothing, and the update, in which its components may start hypotheses or not. The
  /// report's evidence is that of this state; `evidence` has both kinds.
  ObservedDetection observe(std::size_t j, const Observation& observation,
                            const ObservationSource& source) const;
  /// The same for a part of an observation.
  ObservedDetection observe(std::size_t j, WeighedObservation observation) const;
  ObjectUpdateReport update(std::size_t j, const ObservedDetection& observed,
                            const Starters& may_start, LogTotals& evidence);
  /// One more camera on the body, before any object is seen.
  void add_camera(const ConcentratedGaussian<SE3d>& body_camera) {
    joint.append_extrinsic(body_camera);
    if (!rig_motion) rig_motion.emplace();
  }
  /// One more object, never detected.
  void add_object(const ObjectSensor& sensor, const std::optional<ObjectPrior>& prior = {},
                  const std::optional<PutDownMotion>& put_down = {});
  /// Object `j` becomes one that was never detected.
  void forget(std::size_t j);
  /// Camera and objects get the error of the world, which is zero then: before something tells of
  /// it.
  void take_in_world_error();
  /// W^-1 of eq. (31); none where nothing is to be taken out.
  std::optional<Matrix6d> world_information() const;
  /// ObjectBelief::world_information_beyond() of all objects.
  std::vector<Matrix6d> world_information_beyond(const Matrix6d& inverse) const;
  /// The origin of the world moves.
  void move_world(const WorldShift& shift, MovedBases& shared);
  /// A part of the error of the world leaves camera and objects.
  void take_out_world_error(const WorldPart& part);
  /// ObjectBelief::moments_of_others() of all objects.
  KeptVector<OtherMomentsList> moments_of_others(bool released = false);
  /// Time goes on by one frame, in which the camera moved from `camera_before` where that is known.
  void advance(double dt, const std::optional<SE3d>& camera_before,
               const KeptVector<OtherMomentsList>& others);
  /// Object `j` is seen by this camera now.
  void see_from(std::size_t j, const ObservationSource& source) {
    objects[j].belief.see_from(joint, source, objects[j].sensor());
  }

  /// The camera as it is reported: with the error of the world, as all that follows.
  ConcentratedGaussian<SE3d> reported_camera() const;
  /// A hypothesis of an object as it is reported: with the error that all detections have in common
  /// and any angle about an axis of symmetry.
  DetectionState reported(const TrackedObject& object, std::size_t h) const;
  /// The joint Gaussian of camera and leading hypotheses as it is reported, in another world.
  ConcentratedGaussian<PoseStackd> reported_joint(const WorldShift& to_world) const;
  std::vector<HypothesisMean> hypothesis_means(const TrackedObject& object,
                                               const WorldShift& to_world) const;
  /// The leading hypothesis of every object as it is reported.
  std::vector<std::optional<LeadingEstimate>> leading_estimates(const WorldShift& to_world) const;
  /// What a report adds to the covariance of an object at `pose`, world frame.
  static Matrix6d unseen_covariance(const TrackedObject& object, const SE3d& pose);
  /// Whether the gain of a detection is damped: with odometry, for a detector of which only what is
  /// typical is known. Not where poses of objects or of the camera are known: a shift of the world
  /// would move them.
  bool is_damped(const ObjectSensor& sensor) const {
    return settings.has_odometry && !has_known_objects && !camera_given_at &&
           sensor.noise.dependence().is_typical;
  }
  /// The factors on the gains of an observation of the object.
  GainFactors gain_factors(const TrackedObject& object,
                           const WeighedObservation& observation) const;
  /// The score above which recent detections support a hypothesis: more than its birth does [nats].
  double supported_score() const { return settings.birth_score; }

  MultiObjectSettings settings;
  double explained;  ///< squared Mahalanobis distance within which a detection is explained
  MergeBounds merge_bounds;
  JointGaussian joint;
  std::vector<TrackedObject> objects;
  /// Of camera and objects, a shift of the world of which no detection tells: its covariance
  /// Omega, independent of `joint` and `objects`, which are without it ("The error of the world").
  /// The same in all global hypotheses.
  Matrix6d world_error;
  double now_s = 0.0;
  std::optional<std::size_t> motion;  ///< index of the camera's motion in the joint Gaussian
  bool has_known_objects = false;     ///< whether any object was added with a prior
  /// `update_count` when the camera was given last, by set_camera().
  std::optional<std::uint64_t> camera_given_at;
  std::uint64_t next_id = 0;
  std::uint64_t update_count = 0;            ///< number of detections of all objects so far
  std::optional<RigMotion> rig_motion = {};  ///< with extrinsics
  ActiveLimits limits = {};

  // --- prediction, see MultiObjectFilter

  void predict_with_odometry(const SE3d& motion, const Matrix6d& q, double dt);
  void predict_random_walk(const Matrix6d& q, double dt);
  void predict_constant_velocity(double periods, const Matrix6d& q, const Matrix6d& q_motion,
                                 const Matrix6d& at_rest, double dt);
  void set_camera(const ConcentratedGaussian<SE3d>& world_camera, double dt);

  // --- global hypotheses

  /// Loss of one camera for all hypotheses of object `j` after an observation, whose components
  /// start hypotheses where they may [nats]: Runnalls' bound for the merge of
  /// the camera under the leading hypothesis with that under all others. Alternatives that are
  /// supported count as if they tied, whatever their weight, for they can still win.
  double tie_loss(std::size_t j, const ObservedDetection& observed,
                  const Starters& may_start) const;
  /// The component of an observation that is to have a state of its own, because the leading
  /// hypothesis of object `j` would place the camera elsewhere by the others; none where one camera
  /// for all loses little, or where the observation may be clutter.
  std::optional<std::size_t> component_apart(std::size_t j,
                                             const ObservedDetection& observed) const;
  /// Takes all hypotheses of object `j` but the leading one out, into the state that is returned.
  /// `own` and `others` are the logs of the weights of both.
  MultiObjectState split(std::size_t j, LogTotals& own, LogTotals& others);
  /// Becomes the mixture of this and `other`, whose weights, by their logs, sum to one.
  void mix(const MultiObjectState& other, const LogTotals& own, const LogTotals& others);

 private:
  /// N of eq. (31): how a shift of the world moves every block of the joint Gaussian.
  WorldMoves moved_by_world() const;
  /// Erases a pose of the joint Gaussian.
  void erase(std::size_t pose_index);
  /// A camera whose rotation is less certain than a uniform one with the noise `q` of a random walk
  /// becomes independent of all else. Returns whether it did, and so has the noise.
  bool lose_camera(const Matrix6d& q, KeptVector<OtherMomentsList>& others);
  /// A covariance of the camera in its own place, less where it is wide: as far as there is
  /// something left to detect, beside what there is before.
  Matrix6d within_reach(const Matrix6d& covariance, const Matrix6d& before) const;
  /// The same of the noise of the camera's motion.
  Matrix6d within_reach(const Matrix6d& q) const;
  /// The camera gets the covariance of `map` xi_E as noise, for every extrinsic.
  void add_noise_of_extrinsics(const Matrix6d& map);
  void update_weights(TrackedObject& object, const ObservedDetection& observed, double share) const;
  Alternatives births_of(const TrackedObject& object, const WeighedObservation& observation,
                         const Starters& may_start, double share, BirthPlaces* put_down = nullptr);
  /// The weights of an object that is put down elsewhere, and the hypotheses that begin.
  Alternatives take_in_put_down(TrackedObject& object, const ObservedDetection& observed,
                                const Starters& may_start);
  /// A hypothesis of the object where a component of the noise has its mode, without a weight.
  Alternative birth_at(const TrackedObject& object, const WeighedObservation& observation,
                       const ObservationComponent& seen, const NoiseComponent& mode) const;
  void learn(TrackedObject& object, const DetectionUpdate& leading,
             const WeighedObservation& observation);
  void move_poses(TrackedObject& object, const ObservedDetection& observed, bool damped,
                  double log_evidence, Alternatives& births);
  KeptVector<ConditionalPose*> poses_beside_joint(Alternatives& births);
  void shift_back(const TrackedObject& detected, bool damped, const CameraChange& change,
                  Alternatives& births);
  std::size_t reduce(TrackedObject& object);
};

}  // namespace posemix::internal
