// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/moving_object_smoother.hpp"

#include <utility>

#include "moving_object_state.hpp"

namespace posemix {

MovingObjectSmoother::MovingObjectSmoother(ObjectSensor sensor, MotionModels models,
                                           const MovingObjectSettings& settings,
                                           std::optional<std::size_t> most_steps)
    : filter_(std::move(sensor), std::move(models), settings), most_steps_(most_steps) {
  require(!most_steps || *most_steps > 0, "most_steps is 0, expected at least 1");
  filter_.state_->trace();
}

MovingObjectReport MovingObjectSmoother::update(const Observation& observation,
                                                const KnownCamera& camera,
                                                const std::vector<KnownFrame>& frames,
                                                const Matrix6d& change) {
  MovingObjectReport report;
  if (change.isZero(0.0)) {
    report = filter_.update(observation, camera, frames);
  } else {
    MovingObjectFilter updated = predicted(observation.stamp_s, frames, change);
    report = updated.update(observation, camera, frames);
    filter_ = std::move(updated);
  }
  keep_record(change);
  return report;
}

void MovingObjectSmoother::predict(double time_s, const std::vector<KnownFrame>& frames,
                                   const Matrix6d& change) {
  filter_ = predicted(time_s, frames, change);
  filter_.state_->trace_prediction();
  keep_record(change);
}

MovingObjectFilter MovingObjectSmoother::predicted(double time_s,
                                                   const std::vector<KnownFrame>& frames,
                                                   const Matrix6d& change) const {
  MovingObjectFilter later(filter_);
  later.predict(time_s, frames);
  later.move_world(SE3d(), change, later.state_->constant_covariance());
  return later;
}

void MovingObjectSmoother::keep_record(const Matrix6d& change) {
  records_.push_back(std::make_shared<internal::StepRecord>(filter_.state_->record(change)));
  if (most_steps_ && records_.size() > *most_steps_) records_.pop_front();
}

std::vector<MovingObjectEstimate> MovingObjectSmoother::smoothed() const {
  std::vector<MovingObjectEstimate> result(records_.size());
  internal::MovingObjectState state(*filter_.state_);
  internal::MovingBelief belief;
  for (std::size_t i = records_.size(); i-- > 0;) {
    const internal::StepRecord& record = *records_[i];
    if (i + 1 == records_.size()) {
      belief = record.belief;
    } else {
      state.restore(record, record.belief);
      belief = state.pulled_back(*records_[i + 1], belief);
    }
    state.restore(record, belief);
    result[i] = state.estimate();
  }
  return result;
}

MovingObjectSmoothing smooth_moving_object(const ObjectSensor& sensor, const MotionModels& models,
                                           const MovingObjectSettings& settings,
                                           const std::vector<MovingObjectStep>& steps) {
  require(!steps.empty(), "smooth_moving_object: there are no steps, expected at least one");
  MovingObjectSmoother smoother(sensor, models, settings);
  MovingObjectSmoothing result{.sensor = sensor};
  for (const MovingObjectStep& step : steps) {
    result.reports.push_back(smoother.update(step.observation, step.camera, step.frames));
    result.filtered.push_back(smoother.filter().estimate());
  }
  result.estimates = smoother.smoothed();
  result.sensor = smoother.filter().sensor();
  return result;
}

}  // namespace posemix
