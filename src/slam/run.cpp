// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/run.hpp"

#include "frames.hpp"

namespace posemix {
namespace {

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
  internal::check_run(sequence, models);
  ObjectSlam slam(camera_prior, models, settings);
  const std::size_t count = sequence.stamps.size();
  std::vector<FrameEstimate> frames;
  frames.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const FrameInput input = internal::frame_input(sequence, k);
    FrameReport report = k == 0 ? slam.start(input.detections) : slam.step(input);
    frames.push_back(
        internal::frame_estimate(slam.estimate(), slam.pose_indices(), std::move(report)));
    if (options.record_hypotheses) frames.back().hypotheses = internal::snapshots(slam.posterior());
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
