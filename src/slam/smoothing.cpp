// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/smoothing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "frames.hpp"
#include "mode_smoother.hpp"

namespace posemix {
namespace {

using internal::ModeModel;
using internal::ModeSmoother;
/// One hypothesis of every object by its index, none for an object that has none.
using Modes = std::vector<std::optional<std::size_t>>;
using SmoothingClock = std::chrono::steady_clock;

/// Where nothing is known of an object: far wider than what one detection says.
Matrix6d vague() {
  return pose_covariance(Eigen::Vector3d::Constant(3.0), Eigen::Vector3d::Constant(10.0));
}

const MultiObjectFilter& smoothed_filter(const ObjectSlam& slam) {
  if (const MultiObjectFilter* filter = slam.multi_object()) return *filter;
  throw InvalidInput("only the multi-object filter is smoothed");
}

Modes leading_modes(const MultiObjectFilter& filter) {
  Modes modes;
  for (std::size_t j = 0; j < filter.objects(); ++j) modes.push_back(filter.leading(j));
  return modes;
}

/// The window on one mode of every object: what the filter knew before it, and what it knows now.
class WindowOnModes {
 public:
  WindowOnModes(const MultiObjectFilter& before, const MultiObjectFilter& now,
                const MotionSettings& motion, const Modes& modes)
      : before_(before), now_(now) {
    const MultiObjectSettings& settings = now.settings();
    model_ = {.motion = motion,
              .camera_share = settings.camera_share,
              .dependent_frames = now.dependent_frames(),
              .averages = settings.has_odometry};
    for (std::size_t j = 0; j < modes.size(); ++j) {
      if (!modes[j]) continue;
      model_.objects.push_back(j);
      model_.sensors.push_back(&now.sensor(j));
      hypotheses_.push_back(now.hypotheses(j)[*modes[j]]);
    }
  }

  const ModeModel& model() const { return model_; }

  std::vector<Hypothesis> smooth(std::span<const FrameInput* const> frames,
                                 std::size_t passes) const {
    ModeSmoother smoother(model_, frames);
    smoother.pass(start(true));
    const Hypothesis vague_start = start(false);
    for (std::size_t pass = 1; pass < passes; ++pass) smoother.refine(vague_start);
    return smoother.smoothed();
  }

  /// With the covariance of the true error.
  Hypothesis honest(const Hypothesis& joint) const {
    Eigen::MatrixXd covariance = now_.covariance_factor() * joint.covariance();
    for (std::size_t i = 0; i < model_.objects.size(); ++i) {
      const std::size_t pose = model_.first_object() + i;
      const auto at = static_cast<Eigen::Index>(6 * pose);
      covariance.block<6, 6>(at, at) +=
          now_.common_error(model_.objects[i], joint.mean()[kCamera], joint.mean()[pose]);
    }
    return Hypothesis::trusted(joint.mean(), std::move(covariance));
  }

 private:
  /// Before the window's first frame. A mode that the filter did not have then stands where it is
  /// now: for the first pass, that has nothing else to tell right detections from wrong ones, with
  /// its covariance of now; then as good as unknown.
  Hypothesis start(bool first) const {
    Modes known(now_.objects());
    for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
      const auto list = before_.hypotheses(model_.objects[i]);
      const auto found = std::find_if(list.begin(), list.end(), [&](const ObjectHypothesis& other) {
        return other.id == hypotheses_[i].id;
      });
      if (found != list.end())
        known[model_.objects[i]] = static_cast<std::size_t>(found - list.begin());
    }
    const Hypothesis given = before_.joint(known);
    const auto objects_known = static_cast<std::size_t>(std::count_if(
        known.begin(), known.end(), [](const auto& mode) { return mode.has_value(); }));
    const std::size_t others = given.mean().size() - objects_known;

    // Where each pose comes from: a pose of `given`, or a new one.
    const std::size_t size = model_.first_object() + model_.objects.size();
    std::vector<std::optional<std::size_t>> from(size);
    for (std::size_t i = 0; i < std::min(others, model_.first_object()); ++i) from[i] = i;
    PoseStackd poses(size);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(poses.dof(), poses.dof());
    const auto block = [&](std::size_t row, std::size_t column) {
      return covariance.block<6, 6>(static_cast<Eigen::Index>(6 * row),
                                    static_cast<Eigen::Index>(6 * column));
    };
    std::size_t next = others;
    if (model_.has_motion())
      block(kMotion, kMotion) = model_.motion.motion_noise.over(model_.motion.period_s);
    for (std::size_t i = 0; i < model_.objects.size(); ++i) {
      const std::size_t pose = model_.first_object() + i;
      if (known[model_.objects[i]]) {
        from[pose] = next++;
      } else {
        poses[pose] = hypotheses_[i].pose;
        block(pose, pose) = first ? hypotheses_[i].covariance : vague();
      }
    }
    for (std::size_t i = 0; i < size; ++i) {
      if (!from[i]) continue;
      poses[i] = given.mean()[*from[i]];
      for (std::size_t k = 0; k < size; ++k) {
        if (from[k])
          block(i, k) = given.covariance().block<6, 6>(static_cast<Eigen::Index>(6 * *from[i]),
                                                       static_cast<Eigen::Index>(6 * *from[k]));
      }
    }
    return Hypothesis::trusted(std::move(poses), std::move(covariance));
  }

  const MultiObjectFilter& before_;
  const MultiObjectFilter& now_;
  ModeModel model_;
  std::vector<ObjectHypothesis> hypotheses_;  ///< of now, by object of the model
};

}  // namespace

FixedLagSmoother::FixedLagSmoother(const PoseDensity& camera, std::vector<ObjectModel> objects,
                                   const ObjectSlamSettings& settings,
                                   const SmoothingSettings& smoothing, bool record_hypotheses)
    : motion_(settings.motion),
      smoothing_(smoothing),
      record_hypotheses_(record_hypotheses),
      slam_(camera, std::move(objects), settings),
      before_(smoothed_filter(slam_)) {
  require(smoothing.passes > 0, "smoothing: passes is 0, expected at least 1");
  require(before_.settings().camera_gain_noise == 1.0,
          "smoothing: camera_gain_noise must be 1; a camera whose gain is made smaller, or that is "
          "only considered, is not smoothed");
}

std::optional<FrameEstimate> FixedLagSmoother::start(
    const std::vector<std::optional<SE3d>>& detections) {
  return add({0.0, std::nullopt, detections}, slam_.start(detections));
}

std::optional<FrameEstimate> FixedLagSmoother::step(const FrameInput& input) {
  return add(input, slam_.step(input));
}

std::vector<FrameEstimate> FixedLagSmoother::finish() {
  if (window_.empty()) return {};
  std::vector<FrameEstimate> frames = smooth(window_.size());
  window_.clear();
  return frames;
}

std::optional<FrameEstimate> FixedLagSmoother::add(const FrameInput& input, FrameReport report) {
  const MultiObjectFilter& filter = *slam_.multi_object();
  std::vector<bool> known;
  for (std::size_t j = 0; j < filter.objects(); ++j) known.push_back(filter.leading(j).has_value());
  const std::size_t lag = smoothing_.lag_frames;
  window_.push_back(
      {input, std::move(report), std::move(known), lag > 0 ? std::optional(filter) : std::nullopt});
  if (lag == 0 || window_.size() <= lag) return std::nullopt;
  FrameEstimate estimate = smooth(1).front();
  before_ = std::move(*window_.front().after);
  window_.pop_front();
  return estimate;
}

/// The first `count` frames of the window, smoothed.
std::vector<FrameEstimate> FixedLagSmoother::smooth(std::size_t count) {
  const auto start = SmoothingClock::now();
  const MultiObjectFilter& now = *slam_.multi_object();
  std::vector<const FrameInput*> inputs;
  for (const Frame& frame : window_) inputs.push_back(&frame.input);
  const Modes leading = leading_modes(now);
  const WindowOnModes window(before_, now, motion_, leading);
  const std::vector<Hypothesis> joint = window.smooth(inputs, smoothing_.passes);

  std::vector<FrameEstimate> estimates;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<std::optional<std::size_t>> indices(now.objects());
    for (std::size_t i = 0; i < window.model().objects.size(); ++i) {
      const std::size_t object = window.model().objects[i];
      if (window_[k].known[object]) indices[object] = window.model().first_object() + i;
    }
    joint_ = window.honest(joint[k]);
    estimates.push_back(internal::frame_estimate(*joint_, indices, window_[k].report));
    for (std::size_t j = 0; j < now.objects(); ++j) {
      estimates.back().mode_probabilities.push_back(
          indices[j] ? std::optional(now.mode_probability(j)) : std::nullopt);
    }
    if (record_hypotheses_) estimates.back().alternatives.resize(now.objects());
  }

  // Every other hypothesis in place of the leading one of its object.
  for (std::size_t j = 0; record_hypotheses_ && j < now.objects(); ++j) {
    const auto list = now.hypotheses(j);
    for (std::size_t h = 0; h < list.size(); ++h) {
      const bool leads = leading[j] == h;
      if (!leads && list[h].log_weight < std::log(smoothing_.least_weight)) continue;
      Modes modes = leading;
      modes[j] = h;
      const std::vector<Hypothesis> other =
          leads ? joint
                : WindowOnModes(before_, now, motion_, modes).smooth(inputs, smoothing_.passes);
      for (std::size_t k = 0; k < count; ++k) {
        const auto index = estimates[k].pose_indices[j];
        if (index)
          estimates[k].alternatives[j].push_back(
              {list[h].log_weight, other[k].mean()[*index], list[h].id});
      }
    }
  }
  const double seconds = std::chrono::duration<double>(SmoothingClock::now() - start).count() /
                         static_cast<double>(count);
  for (FrameEstimate& estimate : estimates) estimate.report.seconds += seconds;
  return estimates;
}

SlamRun run_smoothed(const Sequence& sequence, const PoseDensity& camera_prior,
                     const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
                     const SmoothingSettings& smoothing, const RunOptions& options) {
  internal::check_run(sequence, models);
  FixedLagSmoother smoother(camera_prior, models, settings, smoothing, options.record_hypotheses);
  const std::size_t count = sequence.stamps.size();
  std::vector<FrameEstimate> frames;
  frames.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const FrameInput input = internal::frame_input(sequence, k);
    auto estimate = k == 0 ? smoother.start(input.detections) : smoother.step(input);
    if (estimate) frames.push_back(std::move(*estimate));
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  for (FrameEstimate& estimate : smoother.finish()) frames.push_back(std::move(estimate));
  auto pose_indices = frames.back().pose_indices;
  SlamRun result{
      std::move(frames), Posterior({{0.0, *smoother.joint()}}), std::move(pose_indices), {}};
  for (std::size_t j = 0; j < models.size(); ++j)
    result.alternatives.push_back(smoother.slam().multi_object()->hypotheses(j));
  return result;
}

}  // namespace posemix
