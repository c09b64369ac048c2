// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <tuple>

#include "detector/state_fields.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"
#include "posemix/filter/moving_object_filter.hpp"
#include "posemix/filter/multi_object_filter.hpp"

/// Settings and models of the filters in a saved state. Settings are checked where the tracker is.
namespace posemix::internal {

template <>
struct StateFields<MultiObjectSettings> {
  static auto tie(auto& x) {
    auto& [max_hypotheses, protected_hypotheses, explained_probability, default_clutter,
           birth_score, score_memory, merge_rotation_rad, merge_translation_m, merge_probability,
           leader_margin, split_loss, max_global_hypotheses, has_odometry, noise_scale_detections,
           least_noise_scale, camera_gain, slow_error_gain, camera_rotation_correction,
           camera_position_correction] = x;
    return std::tie(max_hypotheses, protected_hypotheses, explained_probability, default_clutter,
                    birth_score, score_memory, merge_rotation_rad, merge_translation_m,
                    merge_probability, leader_margin, split_loss, max_global_hypotheses,
                    has_odometry, noise_scale_detections, least_noise_scale, camera_gain,
                    slow_error_gain, camera_rotation_correction, camera_position_correction);
  }
};

template <>
struct StateFields<MovingObjectSettings> {
  static auto tie(auto& x) {
    auto& [max_hypotheses, explained_probability, default_clutter, isolated_clutter,
           recurring_clutter, turned_clutter, lost_rate, merge_rotation_rad, merge_translation_m,
           merge_probability, noise_scale_detections, least_noise_scale, slow_error_gain] = x;
    return std::tie(max_hypotheses, explained_probability, default_clutter, isolated_clutter,
                    recurring_clutter, turned_clutter, lost_rate, merge_rotation_rad,
                    merge_translation_m, merge_probability, noise_scale_detections,
                    least_noise_scale, slow_error_gain);
  }
};

template <>
struct StateFields<StaticMotion> {
  static auto tie(auto& /*x*/) { return std::tuple<>(); }
};
static_assert(std::is_empty_v<StaticMotion>);

template <>
struct StateFields<PutDownMotion> {
  static auto tie(auto& x) {
    auto& [jump_rate, volume_m3] = x;
    return std::tie(jump_rate, volume_m3);
  }
};

template <>
struct StateFields<RandomWalkMotion> {
  static auto tie(auto& x) {
    auto& [sds, frame, break_rate] = x;
    return std::tie(sds, frame, break_rate);
  }
};

template <>
struct StateFields<ConstantVelocityMotion> {
  static auto tie(auto& x) {
    auto& [acceleration_sds, frame, start_sds, break_rate] = x;
    return std::tie(acceleration_sds, frame, start_sds, break_rate);
  }
};

template <>
struct StateFields<AttachedMotion> {
  static auto tie(auto& x) {
    auto& [frame, slip_sds] = x;
    return std::tie(frame, slip_sds);
  }
};

template <>
struct StateFields<MotionModels> {
  static auto tie(auto& x) {
    auto& [models, rates, start] = x;
    return std::tie(models, rates, start);
  }
  static void validate(const MotionModels& x) { posemix::validate(x); }
};

template <>
struct StateFields<ObjectPrior> {
  static ObjectPrior blank() { return {blank_state<ConcentratedGaussian<SE3d>>()}; }
  static auto tie(auto& x) {
    auto& [world, probability] = x;
    return std::tie(world, probability);
  }
};

template <>
struct StateFields<KnownFrame> {
  static auto tie(auto& x) {
    auto& [pose, covariance] = x;
    return std::tie(pose, covariance);
  }
  static void validate(const KnownFrame& x) { posemix::validate(x); }
};

template <>
struct StateFields<MultiObjectFilter> {
  static MultiObjectFilter blank() {
    return {ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity()), {}, {}};
  }
  static auto tie(auto& x) {
    auto& [state] = x;
    return std::tie(state);
  }
};

template <>
struct StateFields<MovingObjectFilter> {
  static MovingObjectFilter blank() { return MovingObjectFilter(blank_state<ObjectSensor>()); }
  static auto tie(auto& x) {
    auto& [state] = x;
    return std::tie(state);
  }
};

}  // namespace posemix::internal
