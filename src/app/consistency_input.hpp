// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posemix/io/tum_covariance.hpp"
#include "posemix/results/trace_tracks.hpp"

namespace posemix {

/// Where estimates and truth come from.
struct ConsistencyInput {
  std::string estimate;              ///< TUM with covariances, or what posemix slam wrote
  std::optional<std::string> truth;  ///< TUM, or a sequence file
  std::vector<std::string> tracks;
  CovarianceConvention convention;
  std::optional<std::string> symmetries;
  std::optional<std::int64_t> object;
  std::optional<std::string> data;
};

/// Whether the truth is a sequence file, by its name.
bool is_sequence_file(const std::string& path);

/// Whether the estimates are what posemix slam wrote: a folder, or a trace.
bool is_slam_result(const std::string& path);

/// Reads estimates with their truth, one entry per pose.
/// @throws InvalidInput for files that are not valid or do not fit one another
std::vector<TraceTrack> read_consistency_input(const ConsistencyInput& input);

}  // namespace posemix
