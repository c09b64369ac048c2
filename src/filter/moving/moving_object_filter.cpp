// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/moving_object_filter.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "filter/multi_object/filter_checks.hpp"
#include "lie/checked_noise.hpp"
#include "moving_object_state.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {
namespace {

void check_moving_settings(const MovingObjectSettings& s) {
  require(s.max_hypotheses > 0, "max_hypotheses is 0, expected at least 1");
  kOpenUnitInterval.check(s.default_clutter, "default_clutter");
  kUnitInterval.check(s.isolated_clutter, "isolated_clutter");
  kUnitInterval.check(s.recurring_clutter, "recurring_clutter");
  NumberRange{.lowest = 0, .highest = 1, .without_highest = true}.check(s.turned_clutter,
                                                                        "turned_clutter");
  kNotNegative.check(s.lost_rate, "lost_rate");
  kNotNegative.check(s.merge_rotation_rad, "merge_rotation_rad");
  kNotNegative.check(s.merge_translation_m, "merge_translation_m");
  NumberRange{.lowest = 0, .without_lowest = true, .with_infinity = true}.check(
      s.noise_scale_detections, "noise_scale_detections");
  NumberRange{.lowest = 0, .highest = 1, .without_lowest = true}.check(s.least_noise_scale,
                                                                       "least_noise_scale");
  kUnitInterval.check(s.slow_error_gain, "slow_error_gain");
}

/// The frame with the symmetric part of its covariance.
KnownFrame checked(KnownFrame frame, const char* name) {
  check_pose(frame.pose, fmt::format("the pose of {}", name));
  frame.covariance = internal::checked_noise(frame.covariance, "the covariance of a frame");
  return frame;
}

void check_time(double time_s, const std::optional<double>& last) {
  kStamp.check(time_s, "the time");
  if (last && time_s < *last)
    throw InvalidInput(fmt::format("the time is {} s, expected {} s or later", time_s, *last));
}

std::vector<KnownFrame> checked(std::vector<KnownFrame> frames) {
  for (KnownFrame& frame : frames) frame = checked(frame, "a frame");
  return frames;
}

}  // namespace

void validate(const KnownFrame& frame) { checked(frame, "the frame"); }

KnownCamera exact_camera(const SE3d& world_camera) { return {.frame = {.pose = world_camera}}; }

KnownCamera still_camera(const ConcentratedGaussian<SE3d>& world_camera) {
  return {.frame = {.pose = world_camera.mean()}, .constant_covariance = world_camera.covariance()};
}

KnownCamera camera_on_arm(const ConcentratedGaussian<SE3d>& world_camera,
                          const Matrix6d& constant) {
  return {.frame = {.pose = world_camera.mean(), .covariance = world_camera.covariance()},
          .constant_covariance = constant};
}

MovingObjectFilter::MovingObjectFilter(ObjectSensor sensor, MotionModels models,
                                       const MovingObjectSettings& settings) {
  require(sensor.other_detectors.empty(),
          "the sensor has other detectors, expected one: a moving object is seen by one detector");
  internal::require_noise_precision(sensor);
  validate(models);
  check_moving_settings(settings);
  state_ =
      std::make_unique<internal::MovingObjectState>(std::move(sensor), std::move(models), settings);
}

MovingObjectFilter::MovingObjectFilter(const MovingObjectFilter& other)
    : state_(std::make_unique<internal::MovingObjectState>(*other.state_)) {}
MovingObjectFilter::MovingObjectFilter(MovingObjectFilter&&) noexcept = default;
MovingObjectFilter& MovingObjectFilter::operator=(const MovingObjectFilter& other) {
  return *this = MovingObjectFilter(other);
}
MovingObjectFilter& MovingObjectFilter::operator=(MovingObjectFilter&&) noexcept = default;
MovingObjectFilter::~MovingObjectFilter() = default;

MovingObjectReport MovingObjectFilter::update(const Observation& observation,
                                              const KnownCamera& camera,
                                              const std::vector<KnownFrame>& frames) {
  validate(observation);
  check_time(observation.stamp_s, state_->time_s());
  const KnownCamera seen_by{
      .frame = checked(camera.frame, "the camera"),
      .constant_covariance = internal::checked_noise(camera.constant_covariance,
                                                     "the constant covariance of the camera")};
  const std::vector<KnownFrame> known = checked(frames);
  if (frames.size() < state_->frames_needed()) {
    throw InvalidInput(fmt::format("{} frames are given, expected {} for the motion models",
                                   frames.size(), state_->frames_needed()));
  }
  state_->advance(observation.stamp_s, known);
  return state_->update(observation, seen_by);
}

void MovingObjectFilter::predict(double time_s, const std::vector<KnownFrame>& frames) {
  check_time(time_s, state_->time_s());
  state_->advance(time_s, checked(frames));
}

std::uint64_t MovingObjectFilter::observation_count() const { return state_->observations(); }
std::optional<double> MovingObjectFilter::time_s() const { return state_->time_s(); }

MovingObjectEstimate MovingObjectFilter::estimate() const {
  require(state_->observations() > 0, "estimate: there was no observation yet");
  return state_->estimate();
}

MovingObjectEstimate MovingObjectFilter::estimate_at(double time_s,
                                                     const std::vector<KnownFrame>& frames) const {
  MovingObjectFilter later(*this);
  later.predict(time_s, frames);
  return later.estimate();
}

Mixture<ConcentratedGaussian<SE3d>> MovingObjectFilter::object_mixture() const {
  require(state_->has_hypotheses(), "object_mixture: the place of the object is not known");
  return Mixture<ConcentratedGaussian<SE3d>>(state_->components());
}

Mixture<ConcentratedGaussian<SE3d>> MovingObjectFilter::relative_mixture(
    const KnownCamera& camera) const {
  require(state_->has_hypotheses(), "relative_mixture: the place of the object is not known");
  return Mixture<ConcentratedGaussian<SE3d>>(
      state_->relative_components(checked(camera.frame, "the camera")));
}

ConcentratedGaussian<SE3d> MovingObjectFilter::relative(const KnownCamera& camera) const {
  require(state_->has_hypotheses(), "relative: the place of the object is not known");
  return state_->relative(checked(camera.frame, "the camera"));
}

ConcentratedGaussian<SE3d> MovingObjectFilter::predicted_detection(
    const KnownCamera& camera) const {
  require(state_->has_hypotheses(), "predicted_detection: the place of the object is not known");
  return state_->predicted_detection(checked(camera.frame, "the camera"));
}

void MovingObjectFilter::move_world(const SE3d& by, const Matrix6d& added,
                                    const Matrix6d& constant) {
  check_pose(by, "the motion of the world");
  const Matrix6d noise = internal::checked_noise(added, "the covariance of a motion of the world");
  state_->move_world(by, noise,
                     internal::checked_noise(constant, "the constant covariance of the camera"));
}

Mixture<ConcentratedGaussian<SE3d>> MovingObjectFilter::predict_to(
    double time_s, const std::vector<KnownFrame>& frames) const {
  MovingObjectFilter later(*this);
  later.predict(time_s, frames);
  return later.object_mixture();
}

const ObjectSensor& MovingObjectFilter::sensor() const { return state_->sensor(); }
const MotionModels& MovingObjectFilter::models() const { return state_->models(); }
const MovingObjectSettings& MovingObjectFilter::settings() const { return state_->settings(); }

}  // namespace posemix
