// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/state_fields.hpp"
#include "posemix/slam/frame_estimate.hpp"
#include "posemix/slam/frame_input.hpp"
#include "posemix/slam/object_model.hpp"

/// What the trackers of object SLAM have in common.
namespace posemix {

/// A filter that estimates camera and objects live. A frame is predict -> update -> reduce ->
/// summarise; objects that are seen for the first time, at any frame, enter after the update.
/// Frames without detections or without odometry are valid.
///
///  - `step` takes every frame in order; at the first one nothing moves. It throws InvalidInput,
///    and changes nothing, when there are detections, but not one per object model, dt is
///    not positive and finite, or the motion, a detection or a candidate is not finite.
///  - `posterior` is the joint posterior, `estimate` one Gaussian in its place.
///  - `pose_index` is the index of an object's pose in both, empty until it was seen.
///  - `detections` counts the detections of an object.
///  - Where there is no object at an index, `pose_index` and `detections` throw InvalidInput.
template <class T>
concept ObjectTracker = std::copyable<T> &&
    requires(T tracker, const T& given, const FrameInput& input, std::size_t object) {
  { tracker.step(input) } -> std::same_as<FrameEstimate>;
  { given.posterior() } -> std::same_as<Posterior>;
  { given.estimate() } -> std::same_as<const Hypothesis&>;
  { given.pose_index(object) } -> std::same_as<std::optional<std::size_t>>;
  { given.objects() } -> std::same_as<const std::vector<ObjectModel>&>;
  { given.detections(object) } -> std::same_as<std::size_t>;
};

/// The detections of one frame for FrameInput, each given by the id of its object model:
///
///     slam.step({.dt = 0.1, .detections = detections_by_id(slam.objects(), {{"mug", pose}})});
///
/// Models that are not named have none.
/// @throws InvalidInput for an id that no model has, with those that there are
std::vector<std::optional<SE3d>> detections_by_id(const std::vector<ObjectModel>& models,
                                                  const std::map<std::string, SE3d>& detections);

/// The object models of a tracker, their ids, and the number of frames so far.
class TrackedObjects {
 public:
  /// @throws InvalidInput when two models share an id, or the covariance of an independent start is
  /// none
  explicit TrackedObjects(std::vector<ObjectModel> models);

  const std::vector<ObjectModel>& models() const { return models_; }
  /// @throws InvalidInput as require
  const ObjectModel& operator[](std::size_t object) const {
    require(object);
    return models_[object];
  }
  std::size_t size() const { return models_.size(); }
  /// @throws InvalidInput, which names the index and the number of models, unless `object` is the
  /// index of one
  void require(std::size_t object) const;
  const ObjectIds& ids() const { return ids_; }
  /// Index of the model with the id.
  std::optional<std::size_t> find(std::string_view id) const;
  /// One more model, whose id no other has. Returns its index.
  std::size_t add(ObjectModel model);

  /// Frames that were begun.
  std::size_t frames() const { return frames_; }
  /// @throws InvalidInput as `begin`
  void check(const FrameInput& input) const;
  /// @throws InvalidInput with the name for an observation that is not valid or does not name an
  /// object or a class
  static void check(const Observation& observation, const std::string& name);
  /// Begins a frame.
  /// @throws InvalidInput, and counts nothing, when there are detections, but not one per model, dt
  /// is not positive and finite after the first frame, the motion, a detection or a candidate is
  /// not finite, or an observation is not valid or does not name an object or a class
  void begin(const FrameInput& input);

 private:
  template <class>
  friend struct internal::StateFields;

  std::vector<ObjectModel> models_;
  ObjectIds ids_;
  std::map<std::string, std::size_t, std::less<>> index_;  ///< by id
  std::size_t frames_ = 0;
};

}  // namespace posemix
