// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <string>

#include "io/json_numbers.hpp"
#include "posemix/results/provenance.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix::internal {

/// What tells the files of one run from those of others.
struct RunStamp {
  std::string run;                           ///< id of the run, which trace.json has too
  std::map<std::string, std::string> files;  ///< SHA-256 by name
};

/// What metrics.json has beside the metrics; null: nothing.
struct MetricsExtras {
  const RunStamp* stamp = nullptr;         ///< the keys `run` and `files`
  const Provenance* provenance = nullptr;  ///< the key of that name
  const Json* verdicts = nullptr;          ///< more keys of `consistency`
};

std::string metrics_text(const Metrics& metrics, const std::string& method,
                         const MetricsExtras& extras);

}  // namespace posemix::internal
