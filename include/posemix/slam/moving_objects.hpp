// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "posemix/base/range.hpp"
#include "posemix/base/state_fields.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/slam/frame_estimate.hpp"
#include "posemix/slam/frame_input.hpp"
#include "posemix/slam/object_model.hpp"

namespace posemix {

/// Objects that move, beside the joint Gaussian of camera and static objects: each has a
/// MovingObjectFilter of its own before the camera as it is known from all others, and none moves
/// the camera or another object (docs/moving-objects.md, "Joined with object SLAM").
class MovingObjects {
 public:
  /// `frames` are the names of the frames that may hold objects.
  explicit MovingObjects(const MovingObjectSettings& settings = {},
                         std::vector<std::string> frames = {});

  /// @throws InvalidInput naming the object when it has several detectors or a prior, a model is
  /// not valid, or is attached to a frame that there is not
  void require_valid(const ObjectModel& model) const;
  /// Such objects may come.
  /// @throws InvalidInput as require_valid
  void expect(const ObjectModel& model);
  /// The object at this index of a tracker moves.
  /// @throws InvalidInput as require_valid
  void add(std::size_t object, const ObjectModel& model);
  bool empty() const { return tracks_.empty(); }
  bool has(std::size_t object) const { return tracks_.contains(object); }
  /// Whether the object moves and was seen.
  bool is_known(std::size_t object) const;
  /// The object becomes one that was never seen.
  void forget(std::size_t object);

  /// Whether an object may be held by the frame.
  /// @throws InvalidInput when there is no such frame
  bool may_hold(std::size_t frame) const {
    internal::check_index(frame, may_hold_.size(), "frame");
    return may_hold_[frame];
  }

  /// @throws InvalidInput for poses of frames that are not valid, and where an object may be held
  /// by a frame of which no pose was given so far
  void check(const FrameInput& input) const;
  /// Predicts all objects by `dt` seconds.
  /// @throws InvalidInput when the time is negative or not finite, or for poses of frames that are
  /// not valid
  void begin(double dt, const std::vector<std::optional<KnownFrame>>& frames);
  /// The objects follow the correction of the camera as far as it is one of an error that was there
  /// when they were seen. `before` is the camera of the last frame, `predicted` before this frame's
  /// updates, and `now` after them.
  void follow(const PoseDensity& before, const PoseDensity& predicted, const PoseDensity& now);
  /// The error of the camera was drawn anew for every image, and lasts from now on.
  void camera_begins_to_last(const PoseDensity& now);
  /// The reverse. `before` is the camera of the last frame.
  void camera_ceases_to_last(const PoseDensity& before);

  /// An observation at the time of the frame.
  /// @throws InvalidInput for an object that does not move, and as MovingObjectFilter::update
  ObjectUpdateReport update(std::size_t object, Observation observation, const KnownCamera& camera);
  /// T_camera_object as the detector sees it, of the most probable hypothesis.
  PoseDensity predicted_detection(std::size_t object, const KnownCamera& camera) const;
  /// Puts the moving objects into the estimate of a frame.
  void report(const KnownCamera& camera, bool with_alternatives, FrameEstimate& frame) const;
  /// The hypotheses of an object. Their cross-covariance with the camera is the camera's constant
  /// error.
  std::vector<ObjectHypothesis> hypotheses(std::size_t object) const;
  /// The object `dt` seconds later; empty until it was seen. Frames stay where they are.
  std::optional<MovingObjectHypothesis> at(std::size_t object, double dt) const;
  /// Probability that the place of an object that was seen is not known.
  double lost_probability(std::size_t object) const;
  /// @throws InvalidInput for an object that does not move
  const MovingObjectFilter& filter(std::size_t object) const;

 private:
  template <class>
  friend struct internal::StateFields;

  struct Track {
    MovingObjectFilter filter;
    MovingObjectFilter unseen;  ///< as it began
  };

  /// @throws InvalidInput for an object that does not move
  void require_moving(std::size_t object) const;
  Track& track(std::size_t object) {
    require_moving(object);
    return tracks_.at(object);
  }
  std::vector<KnownFrame> known_frames() const;
  void move_world(const SE3d& by, const Matrix6d& added, const Matrix6d& constant);

  MovingObjectSettings settings_;
  std::vector<std::string> names_;
  std::vector<bool> may_hold_;           ///< by frame, whether a model is attached to it
  std::map<std::size_t, Track> tracks_;  ///< by the index of the object
  std::vector<std::optional<KnownFrame>> frames_;
  Matrix6d constant_ = Matrix6d::Zero();  ///< error of the camera in all images
  double time_s_ = 0.0;
};

/// Puts what is known of a moving object into the estimate of a frame, but for the pose from the
/// camera; `with_alternatives` all its hypotheses.
/// @throws InvalidInput when there is no such object in the estimate, or no hypothesis
void report_moving(std::size_t object, const MovingObjectEstimate& estimate, bool with_alternatives,
                   FrameEstimate& frame);

/// The hypotheses of a moving object, whose cross-covariance with the camera is `camera`: the
/// camera's error that lasts.
std::vector<ObjectHypothesis> hypotheses_of(const MovingObjectEstimate& estimate,
                                            const Matrix6d& camera);

/// Whether all models are static.
bool is_static(const MotionModels& motion);

/// The model of an object that only stands still until it is put down elsewhere, which is part of
/// the joint Gaussian; none for all others.
std::optional<PutDownMotion> put_down_of(const MotionModels& motion);

/// Whether the object has a track of its own in MultiObjectSlam: not where all its models are
/// static, and not where it is put down elsewhere.
bool has_own_track(const MotionModels& motion);

/// @throws InvalidInput naming the first object with another motion than a static one
void require_static(const std::vector<ObjectModel>& models, const std::string& where);

}  // namespace posemix
