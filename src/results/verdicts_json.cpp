// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "verdicts_json.hpp"

#include <optional>

#include "draw/run_consistency.hpp"

namespace posemix::internal {
namespace {

Json verdict_json(const std::optional<ConsistencyReport>& report) {
  if (!report) return nullptr;
  const NeesSummary& pose = report->pose;
  return {{"verdict", word_of(report->verdict)},
          {"reason", fault_text(*report)},
          {"anees", json_number(pose.anees)},
          {"interval", {json_number(pose.interval.low), json_number(pose.interval.high)}},
          {"effective_frames", json_number(pose.effective_frames)}};
}

}  // namespace

Json verdicts_json(const SlamJob& job, const SlamRun& run) {
  Json relative = Json::object();
  for (std::size_t object = 0; object < job.models.size(); ++object)
    relative[job.models[object].id] = verdict_json(relative_consistency(job, run, object));
  return {{"camera_verdict", verdict_json(camera_consistency(job, run))},
          {"relative_verdicts", std::move(relative)}};
}

}  // namespace posemix::internal
