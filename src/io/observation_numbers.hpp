// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/base/limits.hpp"
#include "posemix/detector/observation.hpp"

/// Observations of a file with their lines, and what their numbers may be.
namespace posemix::internal {

/// The observations of a file in its order, and the lines in which they begin.
struct PlacedObservations {
  std::vector<Observation> observations = {};
  std::vector<std::size_t> lines = {};
};

/// As parse_observations and parse_observation_lines.
PlacedObservations parse_placed_table(std::string_view text, const std::string& name);
PlacedObservations parse_placed_lines(std::string_view text, const std::string& name);

/// What a number must be, for the message where it is not; empty where it is.
std::string_view wrong_stamp(double stamp_s);
std::string_view wrong_position(double coordinate_m);
std::string_view wrong_weight(double weight);
std::string_view wrong_clutter(double probability);

/// What is wrong with a covariance, in the words of the columns of a table.
struct CovarianceFault {
  std::string got;
  std::string_view expected;
};
std::optional<CovarianceFault> fault_of(const Matrix6d& covariance);

}  // namespace posemix::internal
