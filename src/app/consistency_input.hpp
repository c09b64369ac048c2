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

/// Reads estimates with their truth, one entry per pose.
/// @throws InvalidInput for files that are not valid or do not fit one another
std::vector<TraceTrack> read_consistency_input(const ConsistencyInput& input);

}  // namespace posemix
