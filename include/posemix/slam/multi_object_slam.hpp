// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posemix/base/state_fields.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/slam/instance_tracks.hpp"
#include "posemix/slam/motion_settings.hpp"
#include "posemix/slam/moving_objects.hpp"
#include "posemix/slam/rig.hpp"
#include "posemix/slam/tracker.hpp"

namespace posemix {

/// Settings of MultiObjectSlam.
struct MultiObjectSlamSettings {
  MultiObjectSettings filter = {};       ///< has_odometry follows from the motion model
  AssociationSettings association = {};  ///< of candidates
  ExistenceSettings existence = {};      ///< of instances
  HealthSettings health = {};            ///< of tracks
  /// Cameras on the body whose pose is estimated and whose motion is the odometry. None: there is
  /// one, which is the body. Those with a covariance are calibrated on the way.
  std::vector<BodyCamera> cameras = {};
  /// The model of objects that were not declared: an observation of an id that no model has begins
  /// one, with this noise and these symmetries. Without it such an observation is refused.
  std::optional<ObjectModel> on_sight = {};
  MovingObjectSettings moving = {};  ///< of objects that move
  /// Names of the frames that may hold objects, whose poses are known (AttachedMotion).
  std::vector<std::string> frames = {};
  /// An instance with fewer detections is not confirmed, and its model is used again where a
  /// candidate begins a new instance of the class and no model is free.
  std::size_t confirming_detections = 3;
};

/// An observation of an object model, by its index.
struct ObservedObject {
  std::size_t object;
  Observation observation;
  ObservationSource source = {};
};

/// Object SLAM by the MultiObjectFilter: hypotheses of every object for itself, clutter, births.
/// Objects that move are not a part of its joint Gaussian: each has a MovingObjectFilter before the
/// camera as it is known from the static ones (docs/moving-objects.md, "Joined with object SLAM").
///
/// Candidates, and observations that name a class, are associated class by class and image by image
/// (posemix::associate), after all that names its object: those of a known instance update it;
/// those of none take the next free model of the class, or of the instances that give way that
/// which was not seen for longest. Satisfies ObjectTracker.
class MultiObjectSlam {
 public:
  /// `camera` is the prior of T_world_camera at the first frame. Where hypotheses are recorded, an
  /// estimate holds the alternatives of every object.
  /// @throws InvalidInput when a setting is out of range, two models share an id, two models of one
  /// class differ in noise or symmetries, or a model has an independent start, and as
  /// MovingObjects::require_valid
  MultiObjectSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                  const MultiObjectSlamSettings& settings = {}, const MotionSettings& motion = {},
                  bool record_hypotheses = false);

  FrameEstimate step(const FrameInput& input);
  /// What is asked of a pose of the camera that is given, FrameInput::camera; anything goes under
  /// another motion model.
  /// @throws InvalidInput when it is so far from the origin of the world that rounding leaves
  /// nothing of its errors
  void check_camera(const SE3d& world_camera) const;

  /// One more object from the next frame on, such as one of an old map whose place is known by now
  /// (posemix::relocalise). Returns its index.
  /// @throws InvalidInput, and changes nothing, for an id that another model has, and as the
  /// constructor
  std::size_t add(ObjectModel model);
  /// The object is as if it had never been seen, and had no prior: its next sighting begins it
  /// anew. All else stays as it is, also what was learned from its sightings about the camera.
  /// @throws InvalidInput when there is no object at the index
  void forget(std::size_t object);
  /// The same, and takes the object out of an estimate, that of the last frame.
  void forget(std::size_t object, FrameEstimate& last);

  /// Camera and leading hypotheses of the objects that stand still; those that move are
  /// independent of it, and in `moving`.
  Posterior posterior() const { return Posterior({{0.0, estimate()}}); }
  /// Made when it is asked for, which is quadratic in the objects. The reference holds until the
  /// next step.
  const Hypothesis& estimate() const { return filter_.current_joint(); }
  std::optional<std::size_t> pose_index(std::size_t object) const {
    return filter_.pose_index(object);
  }
  const std::vector<ObjectModel>& objects() const { return objects_.models(); }
  /// Detections that made the object what it is, candidates included; zero again when another
  /// instance takes its model.
  std::size_t detections(std::size_t object) const {
    objects_.require(object);
    return tracks_.detections(object);
  }
  /// Probability that the object exists, whatever its mode (docs/existence.md); none before its
  /// first detection, and one for objects with a prior.
  std::optional<double> existence(std::size_t object) const;
  /// Whether it has at least the probability ExistenceSettings::confirmed_probability, and
  /// `confirming_detections`.
  bool is_confirmed(std::size_t object) const;
  /// How often the object was detected, for fit_existence.
  const InstanceCounts& instance_counts(std::size_t object) const {
    objects_.require(object);
    return tracks_.counts(object);
  }
  const MultiObjectFilter& filter() const { return filter_; }
  /// The objects that move. In `filter` they were never seen.
  const MovingObjects& moving() const { return moving_; }
  /// The hypotheses of an object, whether it moves or not; empty until it was seen.
  std::vector<ObjectHypothesis> hypotheses(std::size_t object) const;
  /// T_world_object `dt` seconds after the last frame, as far as it is known by then: for grasping,
  /// where detections are late. Frames that may hold the object stay where they are. Empty until it
  /// was seen.
  /// @throws InvalidInput when dt is negative or not finite, or there is no object at the index
  std::optional<PoseDensity> object_at(std::size_t object, double dt) const;
  /// The cameras on the body as they were given.
  const std::vector<BodyCamera>& cameras() const { return settings_.cameras; }
  /// The cameras on the body as they are known by now: exact ones as they were given, the others
  /// with their estimated pose and its covariance.
  std::vector<BodyCamera> estimated_cameras() const;
  /// @throws InvalidInput for an observation that `step` would refuse
  void check(const Observation& observation) const;
  /// The same for the name of an image, as in FrameInput::images.
  void check_image(const std::string& name) const;
  /// What a frame says of the objects that it names, in the order in which `step` takes it.
  /// @throws InvalidInput for an object, a camera or a detector that is not known
  std::vector<ObservedObject> observed(const FrameInput& input) const;

 private:
  template <class>
  friend struct internal::StateFields;

  /// An observation with where it comes from.
  struct Seen {
    Observation observation;
    ObservationSource source;
    CandidateReport* report;
  };

  /// What the frame has that names a class or an object, checked.
  /// @throws InvalidInput for a camera, a detector or an object that is not known
  std::vector<Seen> sightings_of(const FrameInput& input, FrameReport& report);
  /// The order in which a frame's observations are taken: by the index of the object, then by
  /// detector, camera, class and numbers.
  bool is_taken_before(const Observation& a, const Observation& b) const;
  ObservationSource source_of(const Observation& observation) const;
  void update(std::size_t object, const Observation& observation, const ObservationSource& source,
              FrameReport& report);
  /// Those of objects that move, or of the others.
  void update_named(bool moving, std::span<Seen> sightings, FrameReport& report);
  void update_by_class(bool moving, std::span<Seen> sightings, FrameReport& report);
  void update_image(const std::vector<std::size_t>& models, std::span<Seen* const> image,
                    FrameReport& report);
  CandidateReport new_instance(const std::vector<std::size_t>& models);
  /// What the images of the frame say of existence and health of every object.
  void update_tracks(FrameEstimate& frame);
  /// The images of the frame.
  void look(const FrameInput& input);
  /// Instances of a class that hardly exist are forgotten.
  void forget_deleted();
  FrameEstimate frame_estimate(FrameReport report) const;

  // --- of objects that move, or not
  std::size_t add_object(ObjectModel model);
  bool is_known(std::size_t object) const;
  ObjectUpdateReport update_filter(std::size_t object, const Observation& observation,
                                   const ObservationSource& source);
  PoseDensity predicted_detection(std::size_t object, const ObservationSource& source) const;
  /// The camera of an observation as an object that moves is seen from it.
  KnownCamera known_camera(const ObservationSource& source) const;
  /// The camera, where anything moves.
  std::optional<PoseDensity> camera_for_moving() const;
  /// The objects that move follow the camera from the last frame, where its error lasted or was
  /// drawn for that image alone.
  void follow_camera(const PoseDensity& before, const PoseDensity& predicted, bool lasted);
  /// Probability that the place of an object is known, where it may be put down elsewhere.
  double place_probability(std::size_t object) const;
  /// Puts the objects that move into an estimate.
  void report_moving(FrameEstimate& frame) const;

  TrackedObjects objects_;
  MultiObjectSlamSettings settings_;
  MotionSettings motion_;
  bool record_hypotheses_;
  MultiObjectFilter filter_;
  MovingObjects moving_;
  /// Whether the error of the camera's pose is that of the frames before and after, and not drawn
  /// for this image alone, as that of a given pose is.
  bool camera_lasts_ = true;
  InstanceTracks tracks_;
};

static_assert(ObjectTracker<MultiObjectSlam>);

}  // namespace posemix
