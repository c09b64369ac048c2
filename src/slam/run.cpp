// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/run.hpp"

#include <utility>

#include "slam/frames.hpp"

namespace posemix {

SlamRun run(const Sequence& sequence, const PoseDensity& camera_prior,
            const std::vector<ObjectModel>& models, const ObjectSlamSettings& settings,
            const RunOptions& options) {
  internal::check_run(sequence, models);
  ObjectSlamSettings recording = settings;
  recording.record_hypotheses |= options.record_hypotheses;
  ObjectSlam slam(camera_prior, models, recording);
  const std::size_t count = sequence.stamps.size();
  std::vector<FrameEstimate> frames;
  frames.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    frames.push_back(slam.step(internal::frame_input(sequence, k, slam.multi_object() != nullptr)));
    if (options.estimated) options.estimated(frames.back());
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  if (options.finished) options.finished(slam);
  auto pose_indices = frames.back().pose_indices;
  SlamRun result{std::move(frames), slam.posterior(), std::move(pose_indices), {}};
  if (const auto* tracker = std::get_if<MultiObjectSlam>(&slam.tracker())) {
    for (std::size_t object = 0; object < models.size(); ++object)
      result.hypotheses.push_back(tracker->hypotheses(object));
    result.cameras = tracker->estimated_cameras();
  }
  return result;
}

}  // namespace posemix
