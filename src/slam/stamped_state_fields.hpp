// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <limits>
#include <tuple>

#include "slam/searched_image.hpp"
#include "slam/state_fields.hpp"

/// Estimates, and the history of object SLAM by stamps, in a saved state.
namespace posemix::internal {

template <>
struct StateFields<CandidateStatus> {
  static bool is_value(CandidateStatus x) { return x <= CandidateStatus::dropped; }
};

template <>
struct StateFields<CandidateReport> {
  static auto tie(auto& x) {
    auto& [status, object, recycled] = x;
    return std::tie(status, object, recycled);
  }
};

template <>
struct StateFields<UpdateReport> {
  static auto tie(auto& x) {
    auto& [gated, failed, nis, log_evidence, reductions, update_seconds, reduce_seconds] = x;
    // The multi-object filter has no reductions of a mixture, and what was measured is no state.
    static_cast<void>(nis);
    static_cast<void>(reductions);
    static_cast<void>(update_seconds);
    static_cast<void>(reduce_seconds);
    return std::tie(gated, failed, log_evidence);
  }
};

template <>
struct StateFields<FrameReport> {
  static auto tie(auto& x) {
    auto& [statuses, candidates, observations, nis, update, merges, seconds] = x;
    static_cast<void>(nis);      // tells of one frame, and of none that follow
    static_cast<void>(seconds);  // measured
    return std::tie(statuses, candidates, observations, update, merges);
  }
};

template <>
struct StateFields<HypothesisSnapshot> {
  static HypothesisSnapshot blank() { return {}; }
  static auto tie(auto& x) {
    auto& [log_weight, poses] = x;
    return std::tie(log_weight, poses);
  }
};

template <>
struct StateFields<ObjectAlternative> {
  static ObjectAlternative blank() { return {}; }
  static auto tie(auto& x) {
    auto& [probability, pose, id] = x;
    return std::tie(probability, pose, id);
  }
};

template <>
struct StateFields<ObjectTwist> {
  static ObjectTwist blank() { return {}; }
  static auto tie(auto& x) {
    auto& [mean, covariance] = x;
    return std::tie(mean, covariance);
  }
};

template <>
struct StateFields<FrameEstimate> {
  static FrameEstimate blank() { return {blank_state<PoseDensity>(), {}, {}, {}}; }
  static auto tie(auto& x) {
    auto& [camera, objects, relative, pose_indices, hypotheses, alternatives, mode_probabilities,
           existences, healths, register_again, report, ids, motion_models, twists] = x;
    return std::tie(camera, objects, relative, pose_indices, hypotheses, alternatives,
                    mode_probabilities, existences, healths, register_again, report, ids,
                    motion_models, twists);
  }
  static void validate(const FrameEstimate& x) {
    const std::size_t n = x.ids ? x.ids->size() : 0;
    require_state(
        x.objects.size() == n && x.relative.size() == n && x.pose_indices.size() == n &&
            x.mode_probabilities.size() == n && x.existences.size() == n && x.healths.size() == n &&
            x.register_again.size() == n && x.motion_models.size() == n && x.twists.size() == n &&
            x.report.statuses.size() == n && (x.alternatives.empty() || x.alternatives.size() == n),
        "an estimate of every object");
  }
};

template <>
struct StateFields<EstimateAtStamp> {
  static EstimateAtStamp blank() { return {0.0, blank_state<FrameEstimate>()}; }
  static auto tie(auto& x) {
    auto& [stamp_s, estimate] = x;
    return std::tie(stamp_s, estimate);
  }
};

template <>
struct StateFields<StampCounts> {
  static auto tie(auto& x) {
    auto& [taken, replayed, too_late, resets] = x;
    return std::tie(taken, replayed, too_late, resets);
  }
};

template <>
struct StateFields<StampedSlam::Frame> {
  static auto tie(auto& x) {
    auto& [observations, images, odometry, forgotten] = x;
    return std::tie(observations, images, odometry, forgotten);
  }
};

template <>
struct StateFields<StampedSlam::State> {
  static StampedSlam::State blank() { return {blank_state<MultiObjectSlam>()}; }
  static auto tie(auto& x) {
    auto& [slam, estimate] = x;
    return std::tie(slam, estimate);
  }
};

template <>
struct StateFields<StampedSlam> {
  static StampedSlam blank() {
    return {ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity()), {}};
  }
  static auto tie(auto& x) {
    auto& [settings, has_odometry, is_given, initial, now, checkpoints, frames, odometry, names,
           known_frames, first_poses, newest, counts] = x;
    return std::tie(settings, has_odometry, is_given, initial, now, checkpoints, frames, odometry,
                    names, known_frames, first_poses, newest, counts);
  }
  static void validate(const StampedSlam& x) {
    using Slam = StateFields<MultiObjectSlam>;
    const auto& [settings] = Slam::settings(x.initial_.slam);
    const auto& [motion] = Slam::motion(x.initial_.slam);
    const StampedSlam fresh(ConcentratedGaussian<SE3d>(SE3d(), Matrix6d::Identity()),
                            x.initial_.slam.objects(), settings, motion, x.settings_);
    require_state(x.has_odometry_ == fresh.has_odometry_ && x.is_given_ == fresh.is_given_,
                  "odometry where the motion model has it");
    require_state(x.names_ == fresh.names_ && x.known_frames_.size() == x.names_.size() &&
                      x.first_poses_.size() == x.names_.size(),
                  "poses of the frames of the settings");
    require_state(!x.checkpoints_.empty(), "a state before the history");
    double stamp = -std::numeric_limits<double>::infinity();
    const auto require_stamp = [&](const StampedSlam::State& state) {
      const double next = state.estimate ? state.estimate->stamp_s : stamp;
      require_state(!state.estimate || std::isfinite(next), "stamps that are finite");
      require_state(next >= stamp, "states in the order of their stamps");
      require_state(
          !state.estimate || state.estimate->estimate.objects.size() <= state.slam.objects().size(),
          "an estimate of the objects that there are");
      stamp = next;
    };
    for (const auto& state : x.checkpoints_) require_stamp(state);
    require_stamp(x.now_);
    require_state(!x.initial_.estimate, "a beginning without an estimate");
    for (const auto& [key, frame] : x.frames_) {
      require_state(std::isfinite(key), "stamps that are finite");
      for (const std::string& image : frame.images) x.now_.slam.check_image(image);
      for (const Observation& one : frame.observations) x.now_.slam.check(one);
    }
    for (const auto& [key, pose] : x.odometry_)
      require_state(std::isfinite(key), "stamps that are finite");
    for (const auto& poses : x.known_frames_)
      for (const auto& [key, pose] : poses)
        require_state(std::isfinite(key), "stamps that are finite");
    require_state(!x.newest_ || std::isfinite(*x.newest_), "stamps that are finite");
  }
  static const MultiObjectSlam& initial(const StampedSlam& x) { return x.initial_.slam; }
  static const StampedSlamSettings& stamped(const StampedSlam& x) { return x.settings_; }
};

}  // namespace posemix::internal
