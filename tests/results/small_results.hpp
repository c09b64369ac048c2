// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/small_recording.hpp"
#include "posemix/config/sequence_file.hpp"
#include "posemix/results/results.hpp"

namespace posemix::testing {

/// One run over the small recording and its files.
struct SmallResults {
  explicit SmallResults(const std::vector<std::string>& overrides = {}) {
    TomlDocument document = TomlDocument::parse(kSmallToml, "small.toml");
    for (const std::string& each : overrides) document.apply_override(each);
    job.emplace(read_slam_job(document, {small.folder.path()}));
    slam.emplace(run(job->sequence, job->camera_prior, job->models, job->settings,
                     {.record_hypotheses = job->trace_hypotheses > 0, .progress = {}}));
    metrics = evaluate(job->sequence, *slam);
    for (auto& [name, text] : format_results(*job, *slam, metrics)) files[name] = text;
  }

  SmallFolder small;
  std::optional<SlamJob> job;
  std::optional<SlamRun> slam;
  Metrics metrics;
  std::map<std::string, std::string> files;
};

/// The run with the settings of the file, made once.
inline const SmallResults& results() {
  static const SmallResults results;
  return results;
}

}  // namespace posemix::testing
