// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <tuple>

#include "filter/multi_object/state_fields.hpp"
#include "moving_object_state.hpp"

/// The posterior of MovingObjectFilter in a saved state.
namespace posemix::internal {

template <>
struct StateFields<PlacedObject> {
  static PlacedObject blank() { return {}; }
  static auto tie(auto& x) {
    auto& [pose, twist, slow, covariance] = x;
    return std::tie(pose, twist, slow, covariance);
  }
  static void validate(const PlacedObject& x) {
    require_covariance(x.covariance, 18);
    require_state(x.twist.allFinite() && x.slow.allFinite(), "a twist that is finite");
  }
};

template <>
struct StateFields<MovingHypothesis> {
  static MovingHypothesis blank() { return {}; }
  static auto tie(auto& x) {
    auto& [id, detections, objects, weights, seen_from, turned] = x;
    return std::tie(id, detections, objects, weights, seen_from, turned);
  }
};

template <>
struct StateFields<Arrival> {
  static auto tie(auto& x) {
    auto& [id, weight, from_lost, turned] = x;
    return std::tie(id, weight, from_lost, turned);
  }
};

template <>
struct StateFields<StepTrace> {
  static auto tie(auto& x) {
    auto& [weights, arrivals, merged, correlation, slow_factor, camera] = x;
    return std::tie(weights, arrivals, merged, correlation, slow_factor, camera);
  }
};

template <>
struct StateFields<MovingObjectState> {
  static MovingObjectState blank() { return {blank_state<ObjectSensor>(), {}, {}}; }
  static auto tie(auto& x) {
    auto& [models, settings, detector, modes, generator, explained, merge_bounds, hypotheses, lost,
           frames, constant, origin, time_s, seen_s, observations, next_id, trace] = x;
    return std::tie(models, settings, detector, modes, generator, explained, merge_bounds,
                    hypotheses, lost, frames, constant, origin, time_s, seen_s, observations,
                    next_id, trace);
  }
  static void validate(const MovingObjectState& x) {
    const auto models = static_cast<Eigen::Index>(x.models_.models.size());
    const auto modes = static_cast<Eigen::Index>(x.modes_.count());
    const auto require_weights = [&](const ModeWeights& weights) {
      require_state(
          weights.right.rows() == models && weights.right.cols() == modes && !weights.runs.empty(),
          "a weight for every model and mode");
    };
    require_state(
        x.generator_.rows() == models && x.generator_.cols() == models && x.generator_.allFinite(),
        "rates between all models");
    require_state(
        StateFields<DetectorModes>::components(x.modes_) == x.sensor().noise.components().size(),
        "a mode for every component of the noise");
    require_weights(x.lost_);
    for (const MovingHypothesis& hypothesis : x.hypotheses_) {
      require_weights(hypothesis.weights);
      require_state(static_cast<Eigen::Index>(hypothesis.objects.size()) == models,
                    "a Gaussian for every model");
    }
    require_state(
        (!x.time_s_ || std::isfinite(*x.time_s_)) && (!x.seen_s_ || std::isfinite(*x.seen_s_)),
        "times that are finite");
    require_covariance(x.constant_, 6);
    require_state(x.origin_.allFinite(), "an origin that is finite");
  }
};

}  // namespace posemix::internal
