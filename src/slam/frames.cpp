// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "frames.hpp"

#include <utility>

#include "posemix/density/pose_stack.hpp"

namespace posemix::internal {

void check_run(const Sequence& sequence, const std::vector<ObjectModel>& models) {
  validate(sequence);
  if (models.size() != sequence.objects.size()) {
    throw InvalidInput(fmt::format("{} object models for {} recorded objects", models.size(),
                                   sequence.objects.size()));
  }
}

FrameInput frame_input(const Sequence& sequence, std::size_t frame) {
  FrameInput input;
  for (const ObjectRecording& object : sequence.objects)
    input.detections.push_back(object.detections[frame]);
  if (!sequence.candidates.empty()) input.candidates = sequence.candidates[frame];
  if (frame == 0) return input;
  input.dt = sequence.stamps[frame] - sequence.stamps[frame - 1];
  if (sequence.odometry.empty()) return input;
  const auto& before = sequence.odometry[frame - 1];
  const auto& now = sequence.odometry[frame];
  if (before && now) input.odometry = before->inverse() * *now;
  return input;
}

Hypothesis camera_hypothesis(const PoseDensity& camera, const MotionSettings& motion) {
  Hypothesis hypothesis(PoseStackd(std::vector<SE3d>{camera.mean()}), camera.covariance());
  if (motion.model != MotionModel::constant_velocity) return hypothesis;
  return with_independent_pose(hypothesis, SE3d(), motion.motion_noise.over(motion.period_s));
}

Hypothesis moved(Hypothesis hypothesis, const MotionSettings& motion, const FrameInput& input) {
  switch (motion.model) {
    case MotionModel::odometry:
      return predict_with_odometry(
          std::move(hypothesis), input.odometry.value_or(SE3d()),
          (input.odometry ? motion.noise : motion.unknown_motion).over(input.dt));
    case MotionModel::random_walk:
      return predict_random_walk(std::move(hypothesis), motion.walk.over(input.dt));
    case MotionModel::constant_velocity:
      return predict_constant_velocity(std::move(hypothesis), input.dt / motion.period_s,
                                       motion.noise.over(input.dt),
                                       motion.motion_noise.over(input.dt));
  }
  return hypothesis;
}

FrameEstimate frame_estimate(const Hypothesis& joint,
                             const std::vector<std::optional<std::size_t>>& pose_indices,
                             FrameReport report) {
  FrameEstimate frame{.camera = marginal(joint, kCamera),
                      .objects = {},
                      .relative = {},
                      .pose_indices = pose_indices,
                      .report = std::move(report)};
  for (const auto& index : pose_indices) {
    frame.objects.push_back(index ? std::optional(marginal(joint, *index)) : std::nullopt);
    frame.relative.push_back(index ? std::optional(relative_pose(joint, kCamera, *index))
                                   : std::nullopt);
  }
  return frame;
}

std::vector<HypothesisSnapshot> snapshots(const Posterior& posterior) {
  std::vector<HypothesisSnapshot> result;
  for (const auto& component : posterior.components())
    result.push_back({component.log_weight, component.density.mean()});
  return result;
}

}  // namespace posemix::internal
