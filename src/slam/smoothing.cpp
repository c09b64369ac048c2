// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/smoothing.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/limits.hpp"
#include "posemix/base/stopwatch.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "slam/frames.hpp"
#include "slam/motion.hpp"
#include "slam/smoothing_moving.hpp"
#include "slam/smoothing_window.hpp"

namespace posemix {
namespace {

using namespace internal;

const MultiObjectFilter& smoothed_filter(const ObjectSlam& slam) {
  const MultiObjectFilter* filter = slam.multi_object();
  require(filter != nullptr, "only the multi-object filter is smoothed");
  require(filter->settings().camera_gain > 0.0 || !filter->settings().has_odometry,
          "smoothing: the camera is only considered (its gain is zero), expected a positive gain");
  return *filter;
}

void require_declared_objects(const MultiObjectSlamSettings& settings) {
  require(!settings.on_sight, "smoothing: objects begin on sight, expected models of all objects");
}

/// Which instance a detection is of would have to be smoothed too.
void require_no_candidates(bool has_none) {
  require(has_none,
          "smoothing by a fixed lag: detections that name a class are not smoothed, expected "
          "detections that name their object");
}

/// Whether double precision holds anything of poses that were smoothed: the passes need not
/// converge where nearly nothing is known, as after a gap of days.
bool is_sound(const JointState& joint, const std::vector<std::size_t>& poses) {
  constexpr double kRounding = 1e-12;
  return std::all_of(poses.begin(), poses.end(), [&](std::size_t i) {
    const Matrix6d own = block(joint.covariance, i, i);
    return is_valid_pose(joint.poses[i]) && own.allFinite() &&
           own.diagonal().minCoeff() >= -kRounding;
  });
}

}  // namespace

FixedLagSmoother::FixedLagSmoother(const PoseDensity& camera, std::vector<ObjectModel> objects,
                                   const ObjectSlamSettings& settings,
                                   const SmoothingSettings& smoothing, bool record_hypotheses)
    : motion_(settings.motion),
      smoothing_(smoothing),
      record_hypotheses_(record_hypotheses),
      slam_(camera, std::move(objects), settings),
      before_(smoothed_filter(slam_)) {
  require_static(slam_.objects(), "smoothing by a fixed lag");
  require(smoothing.passes > 0, "smoothing: passes is 0, expected at least 1");
  require_declared_objects(std::get<MultiObjectSlamSettings>(settings.tracker));
  require(camera.covariance().topLeftCorner<3, 3>().trace() < 2.99 * kUniformRotationVariance,
          "smoothing: nothing is known of the camera's rotation at the first frame, expected a "
          "covariance below that of a uniform rotation (not camera.start.pose = \"unknown\")");
  for (const BodyCamera& one : std::get<MultiObjectSlamSettings>(settings.tracker).cameras) {
    if (one.is_exact()) continue;
    throw InvalidInput(
        fmt::format("smoothing: the pose of camera '{}' has a covariance, expected "
                    "exact poses of all cameras",
                    one.name));
  }
}

std::optional<FrameEstimate> FixedLagSmoother::step(const FrameInput& input) {
  require_no_candidates(input.candidates.empty() &&
                        std::all_of(input.observations.begin(), input.observations.end(),
                                    [](const auto& seen) { return seen.class_id.empty(); }));
  FrameEstimate filtered = slam_.step(input);
  ids_ = filtered.ids;
  SmootherFrame taken{{}, std::get<MultiObjectSlam>(slam_.tracker()).observed(input)};
  FrameInput& kept = taken.input;
  kept.dt = input.dt;
  kept.motion = input.motion;
  if (motion_.model == MotionModel::given) kept.camera = input.camera;
  if (is_first_) {  // nothing moves
    kept.dt = 0.0;
    kept.motion.reset();
    is_first_ = false;
  }
  const MultiObjectFilter& filter = *slam_.multi_object();
  std::vector<bool> known;
  known.reserve(filter.object_count());
  for (std::size_t j = 0; j < filter.object_count(); ++j)
    known.push_back(filter.leading(j).has_value());
  const std::size_t lag = smoothing_.lag_frames;
  window_.push_back({std::move(taken), std::move(filtered.report), std::move(known),
                     lag > 0 ? std::optional(filter) : std::nullopt});
  if (lag == 0 || window_.size() <= lag) return std::nullopt;
  FrameEstimate estimate = smooth(1).front();
  before_ = std::move(*window_.front().after);
  window_.pop_front();
  return estimate;
}

std::vector<FrameEstimate> FixedLagSmoother::finish() {
  if (window_.empty()) return {};
  std::vector<FrameEstimate> frames = smooth(window_.size());
  window_.clear();
  return frames;
}

/// Where the camera is at the first frame of the window.
SE3d FixedLagSmoother::scene() const {
  return window_.front().taken.input.camera.value_or(before_.camera().mean());
}

/// The camera and the objects that are known at a frame of the window.
std::vector<std::size_t> FixedLagSmoother::reported_poses(const internal::SmoothingWindow& window,
                                                          std::size_t frame) const {
  std::vector<std::size_t> poses{kCamera};
  for (std::size_t j = 0; j < window_[frame].known.size(); ++j) {
    const auto index = window.pose_index(j);
    if (window_[frame].known[j] && index) poses.push_back(*index);
  }
  return poses;
}

void FixedLagSmoother::require_near(const internal::SmoothingWindow& window,
                                    std::span<const SmootherFrame* const> inputs) const {
  if (const auto object = window.too_far(inputs, smoothing_.passes)) {
    throw InvalidInput(
        fmt::format("smoothing: object '{}' is so far from where the camera begins that double "
                    "precision does not hold what its detector sees, expected a shorter way, a "
                    "lag of a few frames, or a run that is not smoothed",
                    (*ids_)[*object]));
  }
}

void FixedLagSmoother::require_sound(const internal::SmoothingWindow& window,
                                     const std::vector<JointState>& joint) const {
  for (std::size_t k = 0; k < joint.size(); ++k) {
    if (is_sound(joint[k], reported_poses(window, k))) continue;
    throw InvalidInput(
        fmt::format("smoothing: at frame {} of {} nothing is left of the poses, as too little is "
                    "known, a detection is too far or the way is kilometres long, expected shorter "
                    "gaps and ways and detections near by, or a run that is not smoothed",
                    k + 1, joint.size()));
  }
}

/// The first `count` frames of the window, smoothed.
std::vector<FrameEstimate> FixedLagSmoother::smooth(std::size_t count) {
  const Stopwatch stopwatch;
  const MultiObjectFilter& now = *slam_.multi_object();
  std::vector<const SmootherFrame*> inputs;
  inputs.reserve(window_.size());
  for (const Frame& frame : window_) inputs.push_back(&frame.taken);
  const SmoothingWindow window(before_, now, motion_, scene(), leading_modes(now));
  require_near(window, inputs);
  SmoothedModes smoothed = window.smooth(inputs, smoothing_.passes);
  const std::vector<JointState>& joint = smoothed.states;
  require_sound(window, joint);
  camera_lags_ = std::move(smoothed.camera_lags);

  std::vector<FrameEstimate> estimates;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<std::optional<std::size_t>> indices(now.object_count());
    std::vector<std::optional<double>> probabilities(now.object_count());
    for (std::size_t j = 0; j < now.object_count(); ++j) {
      if (!window_[k].known[j]) continue;
      indices[j] = window.pose_index(j);
      probabilities[j] = now.mode_probability(j);
    }
    joint_ = window.reported(joint[k]);
    estimates.push_back(internal::frame_estimate(*joint_, indices, ids_, window_[k].report));
    estimates.back().mode_probabilities = std::move(probabilities);
  }
  if (record_hypotheses_) add_alternatives(inputs, joint, estimates);

  const double seconds = stopwatch.seconds();
  for (FrameEstimate& estimate : estimates)
    estimate.report.seconds += seconds / static_cast<double>(count);
  return estimates;
}

/// Every hypothesis of an object in place of the leading one.
void FixedLagSmoother::add_alternatives(std::span<const SmootherFrame* const> inputs,
                                        const std::vector<JointState>& leading,
                                        std::vector<FrameEstimate>& estimates) const {
  const MultiObjectFilter& now = *slam_.multi_object();
  for (FrameEstimate& estimate : estimates) estimate.alternatives.resize(now.object_count());
  for (std::size_t j = 0; j < now.object_count(); ++j) {
    const auto list = now.hypotheses(j);
    for (std::size_t h = 0; h < list.size(); ++h) {
      Modes modes = leading_modes(now);
      const bool leads = modes[j] == h;
      if (!leads && list[h].probability < smoothing_.least_probability) continue;
      modes[j] = h;
      const SmoothingWindow window(before_, now, motion_, scene(), modes);
      if (window.too_far(inputs, smoothing_.passes)) continue;
      const auto joint = leads ? leading : window.smooth(inputs, smoothing_.passes).states;
      bool is_lost = false;
      for (std::size_t k = 0; k < joint.size(); ++k)
        is_lost = is_lost || !is_sound(joint[k], reported_poses(window, k));
      if (is_lost) continue;
      for (std::size_t k = 0; k < estimates.size(); ++k) {
        if (!estimates[k].pose_indices[j]) continue;
        estimates[k].alternatives[j].push_back(
            {list[h].probability, joint[k].poses[*window.pose_index(j)], list[h].id});
      }
    }
  }
}

SlamRun run_smoothed(const Sequence& sequence, const PoseDensity& camera_prior,
                     const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
                     const SmoothingSettings& smoothing, const RunOptions& options) {
  internal::check_run(sequence, models);
  const bool moves = std::any_of(models.begin(), models.end(),
                                 [](const auto& model) { return !is_static(model.motion); });
  const bool has_classes = internal::has_detections_of_classes(sequence);
  if ((moves || has_classes) && smoothing.lag_frames == 0) {
    const auto* tracker = std::get_if<MultiObjectSlamSettings>(&settings.tracker);
    require(tracker != nullptr, "only the multi-object filter is smoothed");
    require_declared_objects(*tracker);
    return internal::smooth_after_filter(sequence, camera_prior, models, settings, smoothing,
                                         options);
  }
  return internal::smooth_joint(sequence, camera_prior, models, settings, smoothing, options).run;
}

namespace internal {

JointSmoothing smooth_joint(const Sequence& sequence, const PoseDensity& camera_prior,
                            const std::vector<ObjectModel>& models,
                            const ObjectSlamSettings& settings, const SmoothingSettings& smoothing,
                            const RunOptions& options) {
  FixedLagSmoother smoother(camera_prior, models, settings, smoothing, options.record_hypotheses);
  const std::size_t count = sequence.stamps.size();
  std::vector<FrameEstimate> frames;
  frames.reserve(count);
  const auto keep = [&](FrameEstimate&& estimate) {
    if (options.estimated) options.estimated(estimate);
    frames.push_back(std::move(estimate));
  };
  for (std::size_t k = 0; k < count; ++k) {
    auto estimate = smoother.step(internal::frame_input(sequence, k, true));
    if (estimate) keep(std::move(*estimate));
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  for (FrameEstimate& estimate : smoother.finish()) keep(std::move(estimate));
  auto pose_indices = frames.back().pose_indices;
  SlamRun result{
      std::move(frames), Posterior({{0.0, *smoother.joint()}}), std::move(pose_indices), {}};
  for (std::size_t j = 0; j < models.size(); ++j)
    result.hypotheses.push_back(smoother.slam().multi_object()->hypotheses(j));
  return {std::move(result), smoother.camera_lags()};
}

}  // namespace internal

}  // namespace posemix
