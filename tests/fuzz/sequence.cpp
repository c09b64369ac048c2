// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "config/small_recording.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/io/posterior_file.hpp"
#include "posemix/results/results.hpp"
#include "target.hpp"

/// Sequence files over a small recording, then the first frames of `posemix slam` by them and its
/// results.
namespace posemix::fuzzing {
namespace {

constexpr std::size_t kMostFrames = 3;

/// Runs with few hypotheses and frames, because a file may ask for any number.
void run_and_write(const TomlDocument& document, const std::filesystem::path& folder) {
  SlamJob job = read_slam_job(document, {folder});
  if (auto* filter = std::get_if<GaussianSumSettings>(&job.settings.tracker)) {
    ReductionSettings& reduction = filter->reduction;
    reduction.max_components = std::min<std::size_t>(reduction.max_components, 4);
    reduction.merge_from = std::min<std::size_t>(reduction.merge_from, 8);
  }
  if (auto* particles = std::get_if<ParticleFilterSettings>(&job.settings.tracker))
    particles->particles = std::min<std::size_t>(particles->particles, 8);
  const auto progress = [](std::size_t done, std::size_t) { return done < kMostFrames; };
  const SlamRun slam = run(job.sequence, job.camera_prior, job.models, job.settings,
                           {.record_hypotheses = true, .progress = progress});
  for (const auto& [name, text] : format_results(job, slam, evaluate(job.sequence, slam)))
    if (name == "posterior.json") parse_posterior(text, name);
}

}  // namespace

POSEMIX_FUZZ_TARGET(sequence) {
  static const posemix::testing::SmallFolder small;
  takes("", [&] { run_and_write(TomlDocument::parse(bytes, "s.toml"), small.folder.path()); });
}

}  // namespace posemix::fuzzing
