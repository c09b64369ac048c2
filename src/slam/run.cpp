// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/run.hpp"

#include "frames.hpp"

namespace posemix {
namespace {

FrameEstimate estimate_of(const ObjectSlam& slam, FrameReport report, bool record_hypotheses) {
  std::vector<std::optional<std::size_t>> indices;
  for (std::size_t object = 0; object < slam.objects().size(); ++object)
    indices.push_back(slam.pose_index(object));
  FrameEstimate frame = internal::frame_estimate(slam.estimate(), indices, std::move(report));
  const MultiObjectFilter* filter = slam.multi_object();
  if (filter == nullptr) {
    if (record_hypotheses) frame.hypotheses = internal::snapshots(slam.posterior());
    return frame;
  }
  for (std::size_t object = 0; object < slam.objects().size(); ++object) {
    frame.mode_probabilities.push_back(
        indices[object] ? std::optional(filter->mode_probability(object)) : std::nullopt);
    if (!record_hypotheses) continue;
    std::vector<ObjectAlternative>& alternatives = frame.alternatives.emplace_back();
    for (const ObjectHypothesis& hypothesis : filter->hypotheses(object))
      alternatives.push_back({hypothesis.probability, hypothesis.pose, hypothesis.id});
  }
  return frame;
}

ObjectSlamSettings with_one_hypothesis(ObjectSlamSettings settings) {
  settings.kind = SlamFilter::gaussian_sum;
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
    FrameReport report = k == 0 ? slam.start(input.detections, input.candidates) : slam.step(input);
    frames.push_back(estimate_of(slam, std::move(report), options.record_hypotheses));
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  auto pose_indices = frames.back().pose_indices;
  SlamRun result{std::move(frames), slam.posterior(), std::move(pose_indices), {}};
  if (const MultiObjectFilter* filter = slam.multi_object()) {
    for (std::size_t object = 0; object < models.size(); ++object)
      result.alternatives.push_back(filter->hypotheses(object));
  }
  return result;
}

std::pair<std::vector<ObjectModel>, ObjectSlamSettings> as_riekf(std::vector<ObjectModel> models,
                                                                 ObjectSlamSettings settings) {
  for (ObjectModel& model : models) model.noise = model.noise.single_gaussian();
  return {std::move(models), with_one_hypothesis(std::move(settings))};
}

ObjectSlamSettings as_max_mixture(ObjectSlamSettings settings) {
  settings.filter.noise_use = NoiseUse::most_likely;
  return with_one_hypothesis(std::move(settings));
}

}  // namespace posemix
