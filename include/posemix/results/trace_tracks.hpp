// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "posemix/slam/truth_match.hpp"

/// Estimates and truth out of the results of a run.
namespace posemix {

/// One pose of a run over its frames.
struct TraceTrack {
  std::string name;  ///< "camera", "objects/<id>/world" or "objects/<id>/relative"
  std::vector<StampedEstimate> estimates;
  std::vector<StampedTruth> truth;  ///< empty where the recording has none
  SymmetryGroup symmetries = {};    ///< declared for the object
};

/// Reads the poses, covariances and truth of trace.json.
/// @throws InvalidInput naming the file and the place in it; for a trace without covariances, which
/// older versions wrote
std::vector<TraceTrack> read_trace_tracks(const std::filesystem::path& path);

}  // namespace posemix
