// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/smoothing_moving.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/stopwatch.hpp"
#include "slam/frames.hpp"
#include "slam/semidefinite.hpp"

namespace posemix {
namespace internal {

FilteredRun filtered_run(const Sequence& sequence, const PoseDensity& camera_prior,
                         const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
                         const RunOptions& options) {
  ObjectSlam slam(camera_prior, models, settings);
  const auto& tracker = std::get<MultiObjectSlam>(slam.tracker());
  FilteredRun run;
  std::vector<KnownFrame> known(sequence.known_frames.size());
  const std::size_t count = sequence.stamps.size();
  for (std::size_t k = 0; k < count; ++k) {
    const FrameInput input = frame_input(sequence, k, true);
    run.frames.push_back(slam.step(input));
    for (std::size_t i = 0; i < input.frames.size(); ++i)
      if (input.frames[i]) known[i] = *input.frames[i];
    run.known_frames.push_back(known);
    run.camera_lasts.push_back(settings.motion.model != MotionModel::given || !input.camera);
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  run.named = named_recording(sequence, models, run.frames);
  for (std::size_t k = 0; k < run.frames.size(); ++k)
    run.observed.push_back(tracker.observed(frame_input(run.named, k, true)));
  return run;
}

SmoothedTrack smoothed_track(const FilteredRun& run, std::size_t object, const ObjectModel& model,
                             const MovingObjectSettings& settings,
                             const std::vector<FrameEstimate>& frames,
                             const std::vector<CameraError>& errors) {
  MovingObjectSmoother smoother({model.noise, model.symmetries}, model.motion, settings);
  std::vector<std::size_t> steps;  // by frame, the number of steps so far
  std::size_t taken = 0;
  for (std::size_t k = 0; k < run.named.stamps.size(); ++k) {
    const std::size_t before = taken;
    for (const ObservedObject& seen : run.observed[k]) {
      if (seen.object != object) continue;
      Observation observation = seen.observation;
      observation.stamp_s = run.named.stamps[k];
      const KnownFrame camera{frames[k].camera.mean() * seen.source.body_camera,
                              errors[k].of_image};
      // An object that was not seen so far has no place that could change.
      smoother.update(observation, {.frame = camera}, run.known_frames[k],
                      taken == before && taken > 0 ? errors[k].change : Matrix6d(Matrix6d::Zero()));
      ++taken;
    }
    if (taken == before && taken > 0) {
      smoother.predict(run.named.stamps[k], run.known_frames[k], errors[k].change);
      ++taken;
    }
    steps.push_back(taken);
  }
  const std::vector<MovingObjectEstimate> estimates = smoother.smoothed();
  SmoothedTrack track;
  for (const std::size_t step : steps)
    track.push_back(step > 0 ? std::optional(estimates[step - 1]) : std::nullopt);
  return track;
}

}  // namespace internal

namespace {

using namespace internal;

void require_one_detector(const ObjectModel& model) {
  if (model.detectors.empty()) return;
  throw InvalidInput(
      fmt::format("smoothing: object '{}' is put down elsewhere and has {} noise models of "
                  "detectors, expected one",
                  model.id, model.detectors.size() + 1));
}

/// What would be refused after the filter has run.
void require_smoothable(const PoseDensity& camera_prior, const std::vector<ObjectModel>& models,
                        const ObjectSlamSettings& settings, const SmoothingSettings& smoothing) {
  std::vector<ObjectModel> fixed;
  for (const ObjectModel& model : models) {
    if (has_own_track(model.motion)) continue;
    if (put_down_of(model.motion)) require_one_detector(model);
    fixed.push_back(model);
    fixed.back().motion = {};
  }
  const FixedLagSmoother refuses(camera_prior, std::move(fixed), settings, smoothing);
}

/// An estimate that has no error of the camera with this one.
MovingObjectEstimate with_camera_error(MovingObjectEstimate estimate, const Matrix6d& camera) {
  for (MovingObjectHypothesis& hypothesis : estimate.hypotheses) {
    hypothesis.world = PoseDensity::trusted(hypothesis.world.mean(),
                                            Matrix6d(hypothesis.world.covariance() + camera));
  }
  return estimate;
}

/// The error of a pose that is given is drawn anew for every image, but smoothed poses share that
/// of the map. Any other lasts, and changes with the motion.
std::vector<CameraError> camera_errors(const std::vector<FrameEstimate>& frames,
                                       const std::vector<Matrix6d>& lags,
                                       const std::vector<bool>& lasts) {
  std::vector<CameraError> errors(frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Matrix6d& now = frames[k].camera.covariance();
    errors[k].lasting = now;
    if (k == 0) continue;
    const Matrix6d common = 0.5 * (lags[k] + lags[k].transpose());
    if (lasts[k]) {
      errors[k].change = semidefinite(frames[k - 1].camera.covariance() + now - 2.0 * common);
    } else {
      errors[k].of_image = semidefinite(now - common);
      errors[k].lasting = semidefinite(now - errors[k].of_image);
    }
  }
  if (frames.size() > 1 && !lasts[0]) errors[0] = errors[1];
  return errors;
}

/// A smoothed recording, as it is put together.
class MovingSmoothing {
 public:
  MovingSmoothing(const std::vector<ObjectModel>& models, const MovingObjectSettings& settings,
                  FilteredRun run)
      : models_(models), settings_(settings), run_(std::move(run)), tracks_(models.size()) {}

  /// Where objects are put down, before the camera of the filter.
  StaticPart find_places() {
    errors_.assign(run_.frames.size(), {});
    follow(run_.frames,
           [](const ObjectModel& model) { return put_down_of(model.motion).has_value(); });
    return static_part(run_.named, models_, tracks_);
  }

  SlamRun put_together(const StaticPart& part, const JointSmoothing& joint,
                       const std::function<void(FrameEstimate&)>& estimated) {
    const SlamRun& fixed = joint.run;
    keep_first(fixed.frames.size());  // where it was interrupted
    errors_ = camera_errors(fixed.frames, joint.camera_lags, run_.camera_lasts);
    follow(fixed.frames, [](const ObjectModel& model) { return has_own_track(model.motion); });
    SlamRun all{{}, fixed.posterior, {}};
    for (std::size_t k = 0; k < run_.frames.size(); ++k) {
      all.frames.push_back(frame(k, part, fixed.frames[k]));
      if (estimated) estimated(all.frames.back());
    }
    all.pose_indices = all.frames.back().pose_indices;
    for (std::size_t j = 0; j < models_.size(); ++j) {
      const auto at = part.object_at[j].back();
      all.hypotheses.push_back(at ? fixed.hypotheses[*at] : last_hypotheses(j));
    }
    return all;
  }

 private:
  void keep_first(std::size_t frames) {
    run_.frames.erase(run_.frames.begin() + static_cast<std::ptrdiff_t>(frames), run_.frames.end());
    run_.named.stamps.resize(frames);
  }

  template <class Kind>
  void follow(const std::vector<FrameEstimate>& frames, const Kind& kind) {
    for (std::size_t j = 0; j < models_.size(); ++j)
      if (kind(models_[j]))
        tracks_[j] = smoothed_track(run_, j, models_[j], settings_, frames, errors_);
  }

  FrameEstimate frame(std::size_t k, const StaticPart& part, const FrameEstimate& fixed) const {
    const FrameEstimate& filtered = run_.frames[k];
    const std::size_t count = models_.size();
    FrameEstimate frame{.camera = fixed.camera,
                        .objects = std::vector<std::optional<PoseDensity>>(count),
                        .relative = std::vector<std::optional<PoseDensity>>(count),
                        .pose_indices = std::vector<std::optional<std::size_t>>(count),
                        .mode_probabilities = std::vector<std::optional<double>>(count),
                        .existences = filtered.existences,
                        .healths = filtered.healths,
                        .register_again = filtered.register_again,
                        .report = filtered.report,
                        .ids = filtered.ids};
    frame.report.seconds += fixed.report.seconds;
    frame.motion_models.resize(count);
    frame.twists.resize(count);
    if (!filtered.alternatives.empty()) frame.alternatives.resize(count);
    for (std::size_t j = 0; j < count; ++j) {
      if (const auto at = part.object_at[j][k]) {
        frame.objects[j] = fixed.objects[*at];
        frame.relative[j] = fixed.relative[*at];
        frame.pose_indices[j] = fixed.pose_indices[*at];
        frame.mode_probabilities[j] = fixed.mode_probabilities[*at];
        // The mode is right where the place is; unseen for long, it is at none.
        if (frame.mode_probabilities[j] && put_down_of(models_[j].motion) && tracks_[j][k]) {
          const auto& places = tracks_[j][k]->hypotheses;
          *frame.mode_probabilities[j] *= places.empty() ? 0.0 : places.front().probability;
        }
        if (!frame.alternatives.empty()) frame.alternatives[j] = fixed.alternatives[*at];
      } else if (has_own_track(models_[j].motion) && tracks_[j][k]) {
        report_moving(j, *tracks_[j][k], errors_[k], frame);
      }
    }
    return frame;
  }

  static void report_moving(std::size_t object, const MovingObjectEstimate& estimate,
                            const CameraError& error, FrameEstimate& frame) {
    if (estimate.hypotheses.empty()) return;
    const PoseDensity& seen = estimate.hypotheses.front().world;
    const SE3d to_camera = frame.camera.mean().inverse();
    frame.relative[object] = PoseDensity::trusted(
        to_camera * seen.mean(),
        to_camera.adjoint_congruence(Matrix6d(seen.covariance() + error.of_image)));
    posemix::report_moving(object, with_camera_error(estimate, error.lasting),
                           !frame.alternatives.empty(), frame);
  }

  std::vector<ObjectHypothesis> last_hypotheses(std::size_t object) const {
    const SmoothedTrack& track = tracks_[object];
    if (track.empty() || !track.back()) return {};
    const Matrix6d& error = errors_.back().lasting;
    return hypotheses_of(with_camera_error(*track.back(), error), error);
  }

  const std::vector<ObjectModel>& models_;
  MovingObjectSettings settings_;
  FilteredRun run_;
  std::vector<CameraError> errors_;
  std::vector<SmoothedTrack> tracks_;  ///< of objects that move
};

}  // namespace

namespace internal {

SlamRun smooth_after_filter(const Sequence& sequence, const PoseDensity& camera_prior,
                            const std::vector<ObjectModel>& models,
                            const ObjectSlamSettings& settings, const SmoothingSettings& smoothing,
                            const RunOptions& options) {
  require_smoothable(camera_prior, models, settings, smoothing);
  const auto& tracker = std::get<MultiObjectSlamSettings>(settings.tracker);
  ObjectSlamSettings recorded = settings;
  recorded.record_hypotheses |= options.record_hypotheses;
  FilteredRun filtered = filtered_run(sequence, camera_prior, models, recorded, options);
  // What the filter has done when it is stopped is smoothed to its end.
  const bool stopped = filtered.frames.size() < sequence.stamps.size();
  MovingSmoothing moving(models, tracker.moving, std::move(filtered));
  const StaticPart part = moving.find_places();
  return moving.put_together(
      part,
      smooth_joint(part.sequence, camera_prior, part.models, recorded, smoothing,
                   {.record_hypotheses = recorded.record_hypotheses,
                    .progress = stopped ? decltype(options.progress){} : options.progress}),
      options.estimated);
}

}  // namespace internal
}  // namespace posemix
