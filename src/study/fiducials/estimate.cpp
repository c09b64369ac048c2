// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "estimate.hpp"

namespace posemix {

FiducialEstimate estimate_of(const Sequence& sequence, const SlamRun& run,
                             const CameraPoses& cameras) {
  FiducialEstimate estimate;
  estimate.camera.reserve(run.frames.size());
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const SE3d& pose = run.frames[k].camera.mean();
    if (is_finite(pose)) estimate.camera.push_back({sequence.stamps[k], pose});
  }
  estimate.sightings = estimated_sightings(sequence, run, cameras);
  for (std::size_t i = 0; i < sequence.objects.size(); ++i) {
    const auto& world = run.frames.back().objects[i];
    if (world) estimate.tags.emplace(sequence.objects[i].id, world->mean());
  }
  return estimate;
}

}  // namespace posemix
