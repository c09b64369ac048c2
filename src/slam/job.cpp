// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/job.hpp"

namespace posemix {

void SlamJob::use(const SlamMethod& chosen) {
  models = chosen.models(models);
  method = chosen.title();
  settings.tracker = chosen.tracker;
  smoothing = chosen.smoothing;
}

SlamRun run(const SlamJob& job, const RunOptions& options) {
  if (job.smoothing) {
    return run_smoothed(job.sequence, job.camera_prior, job.models, job.settings, *job.smoothing,
                        options);
  }
  return run(job.sequence, job.camera_prior, job.models, job.settings, options);
}

}  // namespace posemix
