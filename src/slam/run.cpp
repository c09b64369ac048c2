// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/run.hpp"

#include "posemix/density/pose_stack.hpp"

namespace posemix {
namespace {

/// T_camera(k-1)_camera(k), where odometry knows both.
std::optional<SE3d> odometry_step(const Sequence& sequence, std::size_t frame) {
  if (sequence.odometry.empty()) return std::nullopt;
  const auto& before = sequence.odometry[frame - 1];
  const auto& now = sequence.odometry[frame];
  if (!before || !now) return std::nullopt;
  return before->inverse() * *now;
}

std::vector<std::optional<SE3d>> detections_at(const Sequence& sequence, std::size_t frame) {
  std::vector<std::optional<SE3d>> detections;
  for (const ObjectRecording& object : sequence.objects)
    detections.push_back(object.detections[frame]);
  return detections;
}

std::vector<HypothesisSnapshot> snapshots(const Posterior& posterior) {
  std::vector<HypothesisSnapshot> result;
  for (const auto& component : posterior.components()) {
    result.push_back({component.log_weight, component.density.mean()});
  }
  return result;
}

FrameEstimate estimate_of(const ObjectSlam& slam, FrameReport report, bool record_hypotheses) {
  const Hypothesis& joint = slam.estimate();
  FrameEstimate frame{marginal(joint, kCamera), {}, {}, {}, {}, std::move(report)};
  for (std::size_t object = 0; object < slam.objects().size(); ++object) {
    const auto index = slam.pose_index(object);
    frame.pose_indices.push_back(index);
    frame.objects.push_back(index ? std::optional(marginal(joint, *index)) : std::nullopt);
    frame.relative.push_back(index ? std::optional(relative_pose(joint, kCamera, *index))
                                   : std::nullopt);
  }
  if (record_hypotheses) frame.hypotheses = snapshots(slam.posterior());
  return frame;
}

ObjectSlamSettings with_one_hypothesis(ObjectSlamSettings settings) {
  settings.filter.update = UpdateRule::linearized;
  settings.filter.reduction.max_components = 1;
  settings.filter.reduction.merge_from = 0;
  return settings;
}

}  // namespace

SlamRun run(const Sequence& sequence, const PoseDensity& camera_prior,
            const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
            const RunOptions& options) {
  validate(sequence);
  if (models.size() != sequence.objects.size()) {
    throw InvalidInput(fmt::format("{} object models for {} recorded objects", models.size(),
                                   sequence.objects.size()));
  }
  ObjectSlam slam(camera_prior, models, settings);
  const std::size_t count = sequence.stamps.size();
  std::vector<FrameEstimate> frames;
  frames.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    FrameReport report;
    if (k == 0) {
      report = slam.start(detections_at(sequence, k));
    } else {
      const double dt = sequence.stamps[k] - sequence.stamps[k - 1];
      report = slam.step({dt, odometry_step(sequence, k), detections_at(sequence, k)});
    }
    frames.push_back(estimate_of(slam, std::move(report), options.record_hypotheses));
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  auto pose_indices = frames.back().pose_indices;
  return {std::move(frames), slam.posterior(), std::move(pose_indices)};
}

std::pair<std::vector<ObjectModel>, ObjectSlamSettings> as_riekf(std::vector<ObjectModel> models,
                                                                 ObjectSlamSettings settings) {
  for (ObjectModel& model : models) model.noise = model.noise.single_gaussian();
  return {std::move(models), with_one_hypothesis(settings)};
}

ObjectSlamSettings as_max_mixture(ObjectSlamSettings settings) {
  settings.filter.noise_use = NoiseUse::most_likely;
  return with_one_hypothesis(settings);
}

}  // namespace posemix
