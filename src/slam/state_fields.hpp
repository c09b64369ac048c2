// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <tuple>

#include "filter/moving/state_fields.hpp"
#include "posemix/slam/stamped_slam.hpp"
#include "trial_camera.hpp"

/// Settings, models and tracks of object SLAM in a saved state.
namespace posemix::internal {

template <>
struct StateFields<AssociationSettings> {
  static auto tie(auto& x) {
    auto& [gate_probability, rotation_cap_probability, least_new_score, least_separation_m,
           certain_probability, joint_assignments] = x;
    return std::tie(gate_probability, rotation_cap_probability, least_new_score, least_separation_m,
                    certain_probability, joint_assignments);
  }
};

template <>
struct StateFields<BetaDistribution> {
  static auto tie(auto& x) {
    auto& [a, b] = x;
    return std::tie(a, b);
  }
};

template <>
struct StateFields<ExistenceSettings> {
  static auto tie(auto& x) {
    auto& [birth_probability, object_rate, clutter_rate, visible_time_s, hidden_time_s, lifetime_s,
           look_time_s, exclusion_m, confirmed_probability, deleted_probability] = x;
    return std::tie(birth_probability, object_rate, clutter_rate, visible_time_s, hidden_time_s,
                    lifetime_s, look_time_s, exclusion_m, confirmed_probability,
                    deleted_probability);
  }
};

template <>
struct StateFields<HealthSettings> {
  static auto tie(auto& x) {
    auto& [mode_probability, window_detections, band_probability, lost_probability,
           register_again_s] = x;
    return std::tie(mode_probability, window_detections, band_probability, lost_probability,
                    register_again_s);
  }
};

template <>
struct StateFields<BodyCamera> {
  static auto tie(auto& x) {
    auto& [name, body_camera, covariance] = x;
    return std::tie(name, body_camera, covariance);
  }
};

template <>
struct StateFields<ProcessNoise> {
  static auto tie(auto& x) {
    auto& [covariance, per] = x;
    return std::tie(covariance, per);
  }
};

template <>
struct StateFields<MotionSettings> {
  static auto tie(auto& x) {
    auto& [model, noise, walk, motion_noise, unknown_motion, period_s] = x;
    return std::tie(model, noise, walk, motion_noise, unknown_motion, period_s);
  }
};

template <>
struct StateFields<ObjectModel> {
  static auto tie(auto& x) {
    auto& [id, noise, independent_start, symmetries, class_id, detectors, prior, motion] = x;
    return std::tie(id, noise, independent_start, symmetries, class_id, detectors, prior, motion);
  }
};

template <>
struct StateFields<MultiObjectSlamSettings> {
  static auto tie(auto& x) {
    auto& [filter, association, existence, health, cameras, on_sight, moving, frames,
           confirming_detections] = x;
    return std::tie(filter, association, existence, health, cameras, on_sight, moving, frames,
                    confirming_detections);
  }
};

template <>
struct StateFields<StampedSlamSettings> {
  static auto tie(auto& x) {
    auto& [history_s, jump_back_s, on_jump_back, jump_ahead_s, checkpoints] = x;
    return std::tie(history_s, jump_back_s, on_jump_back, jump_ahead_s, checkpoints);
  }
};

template <>
struct StateFields<TrackedObjects> {
  static TrackedObjects blank() { return TrackedObjects({}); }
  static auto tie(auto& x) {
    auto& [models, ids, index, frames] = x;
    return std::tie(models, ids, index, frames);
  }
  static void validate(const TrackedObjects& x) {
    require_state(x.ids_ && x.ids_->size() == x.size() && x.index_.size() == x.size(),
                  "an id for every object");
    for (std::size_t j = 0; j < x.size(); ++j)
      require_state((*x.ids_)[j] == x[j].id && x.find(x[j].id) == j, "the ids of the objects");
  }
};

template <>
struct StateFields<Existence> {
  static Existence blank() { return Existence({}); }
  static auto tie(auto& x) {
    auto& [is_object, visible, hidden, gone] = x;
    return std::tie(is_object, visible, hidden, gone);
  }
  static void validate(const Existence& x) {
    const auto& [is_object, visible, hidden, gone] = x;
    require_state((is_object >= 0.0).all() && (visible >= 0.0).all() && (hidden >= 0.0).all() &&
                      gone >= 0.0 && std::abs(visible.sum() + hidden.sum() + gone - 1.0) < 1e-6,
                  "probabilities of existence that sum to one");
  }
};

template <>
struct StateFields<InstanceCounts> {
  static auto tie(auto& x) {
    auto& [images, detections, is_object] = x;
    return std::tie(images, detections, is_object);
  }
};

template <>
struct StateFields<FieldOfView> {
  static auto tie(auto& x) {
    auto& [box, farthest] = x;
    return std::tie(box.min(), box.max(), farthest);
  }
};

template <>
struct StateFields<InstanceTracks::Track> {
  static auto tie(auto& x) {
    auto& [is_known, of_class, class_id, detections, last_frame, existence, counts, since_look_s,
           is_missed, place_probability, bad_s, found_by, found_now, probability, views, weight,
           clutter, inliers, square] = x;
    return std::tie(is_known, of_class, class_id, detections, last_frame, existence, counts,
                    since_look_s, is_missed, place_probability, bad_s, found_by, found_now,
                    probability, views, weight, clutter, inliers, square);
  }
};

template <>
struct StateFields<InstanceTracks::Look> {
  static auto tie(auto& x) {
    auto& [body_camera, is_now, view] = x;
    return std::tie(body_camera, is_now, view);
  }
};

template <>
struct StateFields<InstanceTracks> {
  static InstanceTracks blank() { return InstanceTracks({}, {}, 1, 0.0); }
  static auto tie(auto& x) {
    auto& [existence, health, confirming_detections, least_separation_m, frames, dt, band, tracks,
           duplicates, looks] = x;
    return std::tie(existence, health, confirming_detections, least_separation_m, frames, dt, band,
                    tracks, duplicates, looks);
  }
  static void validate(const InstanceTracks& x) {
    for (const std::size_t object : x.duplicates_)
      require_state(object < x.tracks_.size(), "a duplicate that there is");
  }
  static std::size_t size(const InstanceTracks& x) { return x.tracks_.size(); }
};

template <>
struct StateFields<MovingObjects::Track> {
  static MovingObjects::Track blank() {
    return {blank_state<MovingObjectFilter>(), blank_state<MovingObjectFilter>()};
  }
  static auto tie(auto& x) {
    auto& [filter, unseen] = x;
    return std::tie(filter, unseen);
  }
};

template <>
struct StateFields<MovingObjects> {
  static auto tie(auto& x) {
    auto& [settings, names, may_hold, tracks, frames, constant, time_s] = x;
    return std::tie(settings, names, may_hold, tracks, frames, constant, time_s);
  }
  static void validate(const MovingObjects& x) {
    require_state(x.may_hold_.size() == x.names_.size() && x.frames_.size() == x.names_.size(),
                  "as many frames as names of them");
    require_state(std::isfinite(x.time_s_) && x.constant_.allFinite(), "a time that is finite");
  }
  /// @throws InvalidInput unless exactly the objects that move have a track
  static void require_models(const MovingObjects& x, const TrackedObjects& objects) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < objects.size(); ++j) {
      const bool moves = has_own_track(objects[j].motion);
      require_state(x.has(j) == moves, "a track for every object that moves");
      count += moves ? 1 : 0;
      if (moves) x.require_valid(objects[j]);
    }
    require_state(x.tracks_.size() == count, "a track for every object that moves");
  }
};

template <>
struct StateFields<MultiObjectSlam> {
  static MultiObjectSlam blank() {
    return {ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity()), {}};
  }
  static auto tie(auto& x) {
    auto& [objects, settings, motion, record_hypotheses, filter, moving, camera_lasts, tracks] = x;
    return std::tie(objects, settings, motion, record_hypotheses, filter, moving, camera_lasts,
                    tracks);
  }
  static void validate(const MultiObjectSlam& x) {
    // A new tracker with the same models and settings throws where they are not valid.
    const MultiObjectSlam fresh(trial_camera(x.objects_.models()), x.objects_.models(), x.settings_,
                                x.motion_, x.record_hypotheses_);
    require_state(x.filter_.object_count() == x.objects_.size() &&
                      StateFields<InstanceTracks>::size(x.tracks_) == x.objects_.size() &&
                      x.filter_.extrinsic_count() == fresh.filter_.extrinsic_count(),
                  "the state of every object and camera");
    for (std::size_t j = 0; j < x.objects_.size(); ++j)
      x.filter_.sensor(j, x.objects_[j].detectors.size());  // which throws
    StateFields<MovingObjects>::require_models(x.moving_, x.objects_);
    for (std::size_t i = 0; i < x.settings_.frames.size(); ++i)
      require_state(x.moving_.may_hold(i) || !fresh.moving_.may_hold(i), "a frame of the settings");
  }
  static auto settings(const MultiObjectSlam& x) { return std::tie(x.settings_); }
  static auto motion(const MultiObjectSlam& x) { return std::tie(x.motion_); }
  static bool records(const MultiObjectSlam& x) { return x.record_hypotheses_; }
};

}  // namespace posemix::internal
