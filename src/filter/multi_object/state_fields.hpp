// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <tuple>
#include <vector>

#include "filter/state_fields.hpp"
#include "global_hypotheses.hpp"
#include "joint_gaussian_fields.hpp"

/// The posterior of MultiObjectFilter in a saved state.
namespace posemix::internal {

template <>
struct StateFields<WrongRun> {
  static WrongRun blank() { return {}; }
  static auto tie(auto& x) {
    auto& [place, weight, offset, offset_covariance, log_kept] = x;
    return std::tie(place, weight, offset, offset_covariance, log_kept);
  }
};

template <>
struct StateFields<ModeWeights> {
  static auto tie(auto& x) {
    auto& [right, runs] = x;
    return std::tie(right, runs);
  }
  static void validate(const ModeWeights& x) {
    require_state(x.right.allFinite(), "weights of modes that are finite");
    for (const WrongRun& run : x.runs)
      require_state(run.weight.allFinite() && run.weight.size() == x.right.rows(),
                    "a finite weight for every model in a run of wrong detections");
  }
};

template <>
struct StateFields<DetectorModes> {
  static std::size_t components(const DetectorModes& x) { return x.mode_of_.size(); }
  static DetectorModes blank() { return DetectorModes(blank_state<DetectorNoise>()); }
  static auto tie(auto& x) {
    auto& [mode_of, first, weights, total, mode_time_s, run_length] = x;
    return std::tie(mode_of, first, weights, total, mode_time_s, run_length);
  }
  static void validate(const DetectorModes& x) {
    const auto& [mode_of, first, weights, total, mode_time_s, run_length] = x;
    require_state(!first.empty() && weights.size() == first.size(), "a weight for every mode");
    for (const std::size_t mode : mode_of)
      require_state(mode < first.size(), "a mode that there is");
    for (const std::size_t component : first)
      require_state(component < mode_of.size(), "a component that there is");
    require_state(total > 0.0 && mode_time_s >= 0.0 && run_length >= 1.0, "weights of modes");
  }
};

template <>
struct StateFields<PutDown> {
  static auto tie(auto& x) {
    auto& [motion, detectors] = x;
    return std::tie(motion, detectors);
  }
};

template <>
struct StateFields<LearnedSensor> {
  static LearnedSensor blank() { return LearnedSensor(blank_state<ObjectSensor>()); }
  static auto tie(auto& x) {
    auto& [sensor, given_noise_scale, given_slow_scale, information, detections, last_s, told,
           turned, looked_s, shown, surprises, surprise] = x;
    return std::tie(sensor, given_noise_scale, given_slow_scale, information, detections, last_s,
                    told, turned, looked_s, shown, surprises, surprise);
  }
  static void validate(const LearnedSensor& x) {
    const auto& [sensor, noise, slow, information, detections, last_s, told, turned, looked_s,
                 shown, surprises, surprise] = x;
    require_state(noise.allFinite() && slow.allFinite() && information.allFinite() &&
                      std::isfinite(last_s) && std::isfinite(told) && turned.allFinite() &&
                      std::isfinite(looked_s) && (shown.array() >= 0.0).all() &&
                      (shown.array() <= 1.0).all() && surprise.allFinite(),
                  "a scale of the noise that is finite");
  }
};

template <>
struct StateFields<MergeBounds> {
  static auto tie(auto& x) {
    auto& [rotation_rad, translation_m, squared_distance] = x;
    return std::tie(rotation_rad, translation_m, squared_distance);
  }
};

template <>
struct StateFields<ObservationSource> {
  static ObservationSource blank() { return {}; }
  static auto tie(auto& x) {
    auto& [body_camera, camera, detector] = x;
    return std::tie(body_camera, camera, detector);
  }
};

template <>
struct StateFields<OtherCamera> {
  static OtherCamera blank() { return {}; }
  static auto tie(auto& x) {
    auto& [source, mean, given, covariance, body, body_object, seeing, is_followed] = x;
    return std::tie(source, mean, given, covariance, body, body_object, seeing, is_followed);
  }
  static void validate(const OtherCamera& x) {
    require_state(x.mean.allFinite() && x.given.allFinite() && x.seeing.allFinite(),
                  "a slow error that is finite");
    require_covariance(x.covariance, kPoseDof);
  }
};

template <>
struct StateFields<Standing> {
  static auto tie(auto& x) {
    auto& [log_weight, log_probability, score, id, detections, seen_from, shown, others] = x;
    return std::tie(log_weight, log_probability, score, id, detections, seen_from, shown, others);
  }
  static void validate(const Standing& x) {
    require_state(
        !std::isnan(x.log_weight) && !std::isnan(x.log_probability) && std::isfinite(x.score),
        "a weight and a score that are numbers");
  }
};

template <>
struct StateFields<ConditionalPose> {
  static ConditionalPose blank() { return {}; }
  static auto tie(auto& x) {
    auto& [pose, slow, covariance, cross_covariance, extrinsics] = x;
    return std::tie(pose, slow, covariance, cross_covariance, extrinsics);
  }
  static void validate(const ConditionalPose& x) {
    const Eigen::Index n = x.slow ? 12 : 6;
    require_state(!x.slow || x.slow->allFinite(), "a slow error that is finite");
    require_state(x.covariance.topLeftCorner(n, n).allFinite() &&
                      x.cross_covariance.topRows(n).allFinite() &&
                      (x.extrinsics.cols() == 0 || x.extrinsics.topRows(n).allFinite()),
                  "covariances of a hypothesis that are finite");
  }
};

template <>
struct StateFields<Alternative> {
  static Alternative blank() { return {{}, blank_state<ConditionalPose>()}; }
  static auto tie(auto& x) {
    auto& [standing, pose] = x;
    return std::tie(standing, pose);
  }
};

template <>
struct StateFields<ObjectBelief::Leader> {
  static ObjectBelief::Leader blank() { return {}; }
  static auto tie(auto& x) {
    auto& [standing, position, pose_index] = x;
    return std::tie(standing, position, pose_index);
  }
};

template <>
struct StateFields<ObjectBelief> {
  static auto tie(auto& x) {
    auto& [leader, alternatives, log_absent, log_absence_probability, lost_shown, seen_by] = x;
    return std::tie(leader, alternatives, log_absent, log_absence_probability, lost_shown, seen_by);
  }
  static void validate(const ObjectBelief& x) {
    const auto& [leader, alternatives, log_absent, log_absence_probability, lost_shown, seen_by] =
        x;
    require_state(leader ? leader->position <= alternatives.size() : alternatives.empty(),
                  "a leading hypothesis where there is any");
    require_state(!std::isnan(log_absent) && !std::isnan(log_absence_probability),
                  "a weight of absence that is a number");
  }
};

template <>
struct StateFields<TrackedObject> {
  static auto tie(auto& x) {
    auto& [detectors, put_down, belief, last_update] = x;
    return std::tie(detectors, put_down, belief, last_update);
  }
  static void validate(const TrackedObject& x) {
    const std::size_t n = x.detectors.size();
    require_state(n > 0 && (!x.put_down || x.put_down->detectors.size() == n), "a detector");
    const auto require_shown = [&](const std::vector<ModeWeights>& shown) {
      if (!x.put_down) return;
      require_state(shown.size() == n, "what every detector shows");
      for (std::size_t d = 0; d < n; ++d)
        require_state(shown[d].right.rows() == 1 && !shown[d].runs.empty() &&
                          shown[d].right.cols() ==
                              static_cast<Eigen::Index>(x.put_down->detectors[d].count()),
                      "a weight for every mode of a detector");
    };
    require_shown(x.belief.lost_shown());
    for (std::size_t h = 0; h < x.belief.size(); ++h) require_shown(x.belief.standing(h).shown);
  }
};

template <>
struct StateFields<ActiveLimits> {
  static auto tie(auto& x) {
    auto& [dense, most, kept] = x;
    return std::tie(dense, most, kept);
  }
};

template <>
struct StateFields<LogTotals> {
  static auto tie(auto& x) {
    auto& [weight, probability] = x;
    return std::tie(weight, probability);
  }
};

template <>
struct StateFields<MotionDirections> {
  static MotionDirections blank() { return {}; }
  static auto tie(auto& x) {
    auto& [motions, noise] = x;
    return std::tie(motions, noise);
  }
  static void validate(const MotionDirections& x) {
    require_covariance(x.motions_, kPoseDof);
    require_covariance(x.noise_, kPoseDof);
  }
};

template <>
struct StateFields<SignificantMotion> {
  static SignificantMotion blank() { return {}; }
  static auto tie(auto& x) {
    auto& [directions, motion, noise] = x;
    return std::tie(directions, motion, noise);
  }
  static void validate(const SignificantMotion& x) {
    require_state(x.motion_.allFinite(), "a motion that is finite");
    require_covariance(x.noise_, kPoseDof);
  }
};

template <>
struct StateFields<SignificantPose> {
  static SignificantPose blank() { return {}; }
  static auto tie(auto& x) {
    auto& [directions, has_pose, follower, last] = x;
    return std::tie(directions, has_pose, follower.pose, follower.covariance, last.pose,
                    last.covariance);
  }
  static void validate(const SignificantPose& x) {
    require_covariance(x.follower_.covariance, kPoseDof);
    require_covariance(x.last_.covariance, kPoseDof);
  }
};

template <>
struct StateFields<RigMotion> {
  static RigMotion blank() { return {}; }
  static auto tie(auto& x) {
    auto& [odometry, given, is_told, is_seen_exactly] = x;
    return std::tie(odometry, given, is_told, is_seen_exactly);
  }
};

template <>
struct StateFields<MultiObjectState> {
  static MultiObjectState blank() {
    return {ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity()), {}, {}};
  }
  static auto tie(auto& x) {
    auto& [settings, explained, merge_bounds, joint, objects, world_error, now_s, motion,
           has_known_objects, camera_given_at, next_id, update_count, rig_motion, limits] = x;
    return std::tie(settings, explained, merge_bounds, joint, objects, world_error, now_s, motion,
                    has_known_objects, camera_given_at, next_id, update_count, rig_motion, limits);
  }
  static void validate(const MultiObjectState& x) {
    std::vector<bool> taken(x.joint.size(), false);
    const auto take = [&](std::size_t index) {
      require_state(index < taken.size() && !taken[index], "a block for every pose");
      taken[index] = true;
    };
    for (std::size_t i = 0; i <= x.joint.extrinsics(); ++i) take(i);
    if (x.motion) take(*x.motion);
    for (const TrackedObject& object : x.objects) {
      const std::optional<std::size_t> leading = object.belief.leading();
      if (!leading) continue;
      const bool has_slow = object.sensor().slow_covariance().has_value();
      const std::size_t pose = *object.belief.pose_index();
      take(pose);
      require_state(x.joint.is_pose(pose) && x.joint.blocks_of(pose) == (has_slow ? 2U : 1U),
                    "a pose with the slow error of its detector");
      if (has_slow) take(pose + 1);
      for (std::size_t h = 0; h < object.belief.size(); ++h) {
        for (const OtherCamera& other : object.belief.standing(h).others)
          require_state(
              has_slow && (!other.source.camera || *other.source.camera < x.joint.extrinsics()),
              "slow errors of the cameras that there are");
        if (h == *leading) continue;
        const ConditionalPose other = object.belief.pose(x.joint, h);
        require_state(other.slow.has_value() == has_slow &&
                          other.extrinsics.cols() == offset(x.joint.extrinsics()),
                      "a hypothesis with the slow error and the cameras that there are");
      }
    }
    for (const bool one : taken) require_state(one, "a pose for every block");
    require_state(std::isfinite(x.now_s), "a time that is finite");
    require_covariance(x.world_error, kPoseDof);
    require_state(x.rig_motion.has_value() == (x.joint.extrinsics() > 0),
                  "the motion of a body with the cameras that there are");
    require_state(!x.camera_given_at || *x.camera_given_at <= x.update_count,
                  "a camera that was given before the last detection");
  }
};

template <>
struct StateFields<GlobalHypotheses::Weighted> {
  static GlobalHypotheses::Weighted blank() { return {blank_state<MultiObjectState>()}; }
  static auto tie(auto& x) {
    auto& [state, log] = x;
    return std::tie(state, log);
  }
};

template <>
struct StateFields<GlobalHypotheses> {
  static GlobalHypotheses blank() { return GlobalHypotheses(blank_state<MultiObjectState>()); }
  static auto tie(auto& x) {
    auto& [list, origin, mutex, summary, joint, of_a_pose] = x;
    // The others are made from the list when they are asked for.
    static_cast<void>(of_a_pose);
    static_cast<void>(mutex);
    static_cast<void>(summary);
    static_cast<void>(joint);
    return std::tie(list, origin);
  }
  static void validate(const GlobalHypotheses& x) {
    require_state(!x.list_.empty(), "a global hypothesis");
    require_state(x.origin_.allFinite(), "an origin that is finite");
    const MultiObjectState& first = x.first();
    for (const auto& [state, log] : x.list_) {
      require_state(!std::isnan(log.weight) && !std::isnan(log.probability),
                    "weights of global hypotheses that are numbers");
      require_state(state.objects.size() == first.objects.size() &&
                        state.joint.extrinsics() == first.joint.extrinsics() &&
                        state.motion.has_value() == first.motion.has_value(),
                    "global hypotheses of the same objects and cameras");
      require_state(state.world_error == first.world_error,
                    "global hypotheses with the same error of the world");
      for (std::size_t j = 0; j < state.objects.size(); ++j)
        require_state(
            state.objects[j].detectors.size() == first.objects[j].detectors.size() &&
                (state.objects[j].put_down == nullptr) == (first.objects[j].put_down == nullptr),
            "global hypotheses with the same detectors");
    }
  }
};

}  // namespace posemix::internal
