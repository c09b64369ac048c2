// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <string>

#include "posemix/results/provenance.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix::internal {

/// What tells the files of one run from those of others.
struct RunStamp {
  std::string run;                           ///< id of the run, which trace.json has too
  std::map<std::string, std::string> files;  ///< SHA-256 by name
};

/// metrics.json, with the keys `run` and `files`, and `provenance`, where they are not null.
std::string metrics_text(const Metrics& metrics, const std::string& method, const RunStamp* stamp,
                         const Provenance* provenance);

}  // namespace posemix::internal
