// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <filesystem>
#include <variant>

#include "posemix/config/sequence_file.hpp"
#include "posemix/io/posterior_file.hpp"
#include "posemix/results/results.hpp"

namespace posemix::testing {

/// The first frames of `posemix slam` by a sequence file, whose results are written and of which
/// the posterior is read. With few hypotheses, because a damaged file may ask for any number.
inline void run_first_frames(const TomlDocument& document, const std::filesystem::path& folder,
                             std::size_t frames) {
  SlamJob job = read_slam_job(document, {folder});
  if (auto* filter = std::get_if<GaussianSumSettings>(&job.settings.tracker)) {
    ReductionSettings& reduction = filter->reduction;
    reduction.max_components = std::min<std::size_t>(reduction.max_components, 4);
    reduction.merge_from = std::min<std::size_t>(reduction.merge_from, 8);
  }
  if (auto* particles = std::get_if<ParticleFilterSettings>(&job.settings.tracker))
    particles->particles = std::min<std::size_t>(particles->particles, 8);
  const auto progress = [&](std::size_t done, std::size_t) { return done < frames; };
  const SlamRun slam = run(job.sequence, job.camera_prior, job.models, job.settings,
                           {.record_hypotheses = true, .progress = progress});
  for (const auto& [name, text] : format_results(job, slam, evaluate(job.sequence, slam)))
    if (name == "posterior.json") parse_posterior(text, name);
}

}  // namespace posemix::testing
