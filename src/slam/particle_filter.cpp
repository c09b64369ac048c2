// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/particle_filter.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "frames.hpp"
#include "particles.hpp"

namespace posemix {
namespace {

void check_particles(const ParticleFilterSettings& settings) {
  require(settings.particles > 0, "particle filter: there are 0 particles, expected at least 1");
  require(settings.hypotheses > 0, "particle filter: hypotheses is 0, expected at least 1");
  require(settings.motion.period_s > 0.0, "motion: period_s must be positive");
  if (!(settings.resample_below >= 0.0 && settings.resample_below <= 1.0)) {
    throw InvalidInput(
        fmt::format("particle filter: resample_below is {}, expected a number in [0, 1]",
                    settings.resample_below));
  }
  checked_covariance(settings.kernel, 6, "particle filter: kernel");
}

/// The heaviest components, the first of equals before the others.
Posterior heaviest_of(const Posterior& posterior, std::size_t count) {
  std::vector<Component<Hypothesis>> components = posterior.components();
  std::stable_sort(components.begin(), components.end(),
                   [](const auto& a, const auto& b) { return a.log_weight > b.log_weight; });
  if (components.size() > count)
    components.erase(components.begin() + static_cast<std::ptrdiff_t>(count), components.end());
  return Posterior(std::move(components));
}

}  // namespace

SlamRun run_particle_filter(const Sequence& sequence, const PoseDensity& camera_prior,
                            const std::vector<ObjectModel>& models,
                            const ParticleFilterSettings& settings, const RunOptions& options) {
  internal::check_run(sequence, models);
  require(sequence.candidates.empty(),
          "the particle filter needs detections that name their object, got candidates");
  check_particles(settings);
  internal::ParticleCloud cloud(camera_prior, models, settings);
  const std::size_t count = sequence.stamps.size();
  std::vector<FrameEstimate> frames;
  frames.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    const FrameInput input = internal::frame_input(sequence, k);
    if (k > 0) cloud.predict(input);
    FrameReport report = cloud.observe(input.detections);
    const Posterior posterior = cloud.posterior();
    const Hypothesis joint =
        merge<PoseStackd>(std::span(posterior.components()), settings.merge).component.density;
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    frames.push_back(internal::frame_estimate(joint, cloud.pose_indices(), std::move(report)));
    if (options.record_hypotheses)
      frames.back().hypotheses = internal::snapshots(heaviest_of(posterior, settings.hypotheses));
    if (options.progress && !options.progress(k + 1, count)) break;
  }
  auto pose_indices = frames.back().pose_indices;
  return {std::move(frames), heaviest_of(cloud.posterior(), settings.hypotheses),
          std::move(pose_indices)};
}

}  // namespace posemix
