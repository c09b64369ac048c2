// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "posemix/filter/moving_object_filter.hpp"

namespace posemix {

namespace internal {
struct StepRecord;
}  // namespace internal

/// A filter of one moving object that also looks back: it keeps what it knew at every observation,
/// and gives the object at each of these times from all observations so far
/// (docs/moving-objects.md, "Looking ahead").
class MovingObjectSmoother {
 public:
  /// Of the last `most_steps` observations and predictions; none is all of them. With n + 1 the
  /// first of smoothed() is the estimate with a fixed lag of n of them.
  /// @throws InvalidInput as MovingObjectFilter, and for less than one step
  explicit MovingObjectSmoother(ObjectSensor sensor, MotionModels models = {},
                                const MovingObjectSettings& settings = {},
                                std::optional<std::size_t> most_steps = {});

  /// As MovingObjectFilter::update. `change` is the covariance by which the error of the camera's
  /// pose has changed since the last step (perturbation on the left, world frame).
  /// @throws InvalidInput as there, and for a covariance that is not positive semidefinite
  MovingObjectReport update(const Observation& observation, const KnownCamera& camera,
                            const std::vector<KnownFrame>& frames = {},
                            const Matrix6d& change = Matrix6d::Zero());

  /// As MovingObjectFilter::predict: a step without an observation.
  /// @throws InvalidInput as update
  void predict(double time_s, const std::vector<KnownFrame>& frames = {},
               const Matrix6d& change = Matrix6d::Zero());

  /// The object at the times of the steps that are kept, the oldest first, given all observations
  /// so far. The last one is the filter's.
  std::vector<MovingObjectEstimate> smoothed() const;

  /// The filter after the last observation.
  const MovingObjectFilter& filter() const { return filter_; }

 private:
  /// The filter at a later time, before a camera whose error has changed.
  MovingObjectFilter predicted(double time_s, const std::vector<KnownFrame>& frames,
                               const Matrix6d& change) const;
  void keep_record(const Matrix6d& change);

  MovingObjectFilter filter_;
  std::optional<std::size_t> most_steps_;
  std::deque<std::shared_ptr<const internal::StepRecord>> records_;
};

/// An observation of one moving object, with what is known at its time.
struct MovingObjectStep {
  Observation observation;              ///< its stamp is the time
  KnownCamera camera = {};              ///< T_world_camera
  std::vector<KnownFrame> frames = {};  ///< those that the models name
};

/// A recording of one moving object, smoothed. The lists have one entry for every step.
struct MovingObjectSmoothing {
  std::vector<MovingObjectEstimate> estimates = {};  ///< given all steps
  std::vector<MovingObjectEstimate> filtered = {};   ///< given the steps up to it
  std::vector<MovingObjectReport> reports = {};      ///< of the filter
  ObjectSensor sensor;  ///< with the scale of its noise as learned by the end
};

/// The object at every step of a recording from all of its steps: a MovingObjectSmoother that keeps
/// all of them.
/// @throws InvalidInput as MovingObjectFilter, and for an empty list of steps
MovingObjectSmoothing smooth_moving_object(const ObjectSensor& sensor, const MotionModels& models,
                                           const MovingObjectSettings& settings,
                                           const std::vector<MovingObjectStep>& steps);

}  // namespace posemix
