// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <tuple>

#include "density/state_fields.hpp"
#include "posemix/detector/object_sensor.hpp"
#include "posemix/detector/observation.hpp"

/// Detectors and observations in a saved state.
namespace posemix::internal {

template <>
struct StateFields<NoiseComponent> {
  static auto tie(auto& x) {
    auto& [weight, covariance, frame, offset, run_length] = x;
    return std::tie(weight, covariance, frame, offset, run_length);
  }
};

template <>
struct StateFields<Clutter> {
  static auto tie(auto& x) {
    auto& [weight, volume_m3] = x;
    return std::tie(weight, volume_m3);
  }
};

template <>
struct StateFields<SlowError> {
  static auto tie(auto& x) {
    auto& [covariance, correlation_time_s, correlation_angle_rad] = x;
    return std::tie(covariance, correlation_time_s, correlation_angle_rad);
  }
};

template <>
struct StateFields<NoiseDependence> {
  static auto tie(auto& x) {
    auto& [slow, common, mode_time_s, is_typical, given_covariance] = x;
    return std::tie(slow, common, mode_time_s, is_typical, given_covariance);
  }
};

template <>
struct StateFields<DetectorNoise> {
  static DetectorNoise blank() { return DetectorNoise({NoiseComponent{}}); }
  static auto tie(auto& x) {
    auto& [components, clutter, dependence] = x;
    return std::tie(components, clutter, dependence);
  }
  static void validate(const DetectorNoise& x) {
    // Which throws.
    static_cast<void>(DetectorNoise(x.components(), x.clutter(), x.dependence()));
  }
};

template <>
struct StateFields<SymmetryAxis> {
  static auto tie(auto& x) {
    auto& [direction, point] = x;
    return std::tie(direction, point);
  }
};

template <>
struct StateFields<SymmetryGroup> {
  static auto tie(auto& x) {
    auto& [elements, inverses, axes, turns, generators] = x;
    return std::tie(elements, inverses, axes, turns, generators);
  }
  static void validate(const SymmetryGroup& x) {
    require_state(!x.elements_.empty() && x.inverses_.size() == x.elements_.size(),
                  "symmetries with an inverse each");
    require_state(x.generators_.rows() == 6 &&
                      x.generators_.cols() == static_cast<Eigen::Index>(x.axes_.size()) &&
                      x.axes_.size() <= 3 && x.axes_.size() != 2,
                  "a direction for every axis of symmetry");
    require_state(x.generators_.allFinite(), "axes that are finite");
  }
};

template <>
struct StateFields<SymmetryGroup::Turns> {
  static auto tie(auto& x) {
    auto& [axis, step_rad] = x;
    return std::tie(axis, step_rad);
  }
};

template <>
struct StateFields<ObjectSensor> {
  static ObjectSensor blank() { return {.noise = blank_state<DetectorNoise>()}; }
  static auto tie(auto& x) {
    auto& [noise, symmetries, other_detectors, slow_units, noise_scale, slow_scale] = x;
    return std::tie(noise, symmetries, other_detectors, slow_units, noise_scale, slow_scale);
  }
  static void validate(const ObjectSensor& x) {
    require_state((x.noise_scale.array() > 0.0).all() && x.noise_scale.allFinite() &&
                      (x.slow_scale.array() > 0.0).all() && x.slow_scale.allFinite(),
                  "scales of the noise that are positive and finite");
  }
};

template <>
struct StateFields<ObservationComponent> {
  static auto tie(auto& x) {
    auto& [weight, pose, covariance] = x;
    return std::tie(weight, pose, covariance);
  }
};

template <>
struct StateFields<Observation> {
  static auto tie(auto& x) {
    auto& [object, class_id, components, clutter, camera, detector, stamp_s, score] = x;
    return std::tie(object, class_id, components, clutter, camera, detector, stamp_s, score);
  }
  static void validate(const Observation& x) { posemix::validate(x); }
};

}  // namespace posemix::internal
