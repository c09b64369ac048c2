// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "slam/frames.hpp"

#include <algorithm>
#include <utility>

#include "posemix/density/pose_stack.hpp"

namespace posemix::internal {

void check_run(const Sequence& sequence, const std::vector<ObjectModel>& models) {
  validate(sequence);
  if (models.size() != sequence.objects.size()) {
    throw InvalidInput(fmt::format("{} object models for {} recorded objects", models.size(),
                                   sequence.objects.size()));
  }
  for (std::size_t object = 0; object < models.size(); ++object) {
    const std::string& recorded = sequence.objects[object].id;
    if (models[object].id == recorded) continue;
    throw InvalidInput(fmt::format("object model {} is '{}', but recorded object {} is '{}'",
                                   object, models[object].id, object, recorded));
  }
}

FrameInput frame_input(const Sequence& sequence, std::size_t frame, bool takes_observations) {
  FrameInput input;
  if (takes_observations && !sequence.observations.empty()) {
    input.observations = sequence.observations[frame];
  } else {
    for (const ObjectRecording& object : sequence.objects)
      input.detections.push_back(object.detections[frame]);
    // An entry for every object, though none was detected, would say that there is an image.
    const bool any = std::any_of(input.detections.begin(), input.detections.end(),
                                 [](const auto& detection) { return detection.has_value(); });
    if (!any) input.detections.clear();
  }
  if (!sequence.candidates.empty()) input.candidates = sequence.candidates[frame];
  if (!sequence.images.empty()) input.images = sequence.images[frame];
  for (const FrameRecording& known : sequence.known_frames)
    input.frames.push_back(known.poses[frame]);
  // It is looked at where the camera is given.
  if (!sequence.odometry.empty()) input.camera = sequence.odometry[frame];
  if (frame == 0) return input;
  input.dt = sequence.stamps[frame] - sequence.stamps[frame - 1];
  if (sequence.odometry.empty()) return input;
  const auto& before = sequence.odometry[frame - 1];
  const auto& now = sequence.odometry[frame];
  if (before && now) input.motion = before->inverse() * *now;
  return input;
}

void require_plain_detections(const FrameInput& input, const char* filter) {
  if (input.candidates.empty() && input.observations.empty()) return;
  const bool candidates = !input.candidates.empty();
  throw InvalidInput(fmt::format(
      "frame: {} {} for {}, expected detections that name their object, or the multi-object filter",
      candidates ? input.candidates.size() : input.observations.size(),
      candidates ? "candidates" : "observations", filter));
}

std::vector<std::optional<SE3d>> all_detections(const FrameInput& input, std::size_t objects) {
  return input.detections.empty() ? std::vector<std::optional<SE3d>>(objects) : input.detections;
}

FrameEstimate frame_estimate(const Hypothesis& joint,
                             const std::vector<std::optional<std::size_t>>& pose_indices,
                             const ObjectIds& ids, FrameReport report) {
  FrameEstimate frame{.camera = marginal(joint, kCamera),
                      .objects = {},
                      .relative = {},
                      .pose_indices = pose_indices,
                      .report = std::move(report),
                      .ids = ids};
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
