// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "posemix/slam/simulation.hpp"

/// Reads the configuration of `posemix simulate`.
namespace posemix {

/// The content of a simulation file.
struct SimulationFile {
  SimulationConfig config;
  /// The table [filter] for the sequence file: keys, and values in the form of TOML.
  std::vector<std::pair<std::string, std::string>> filter;
};

/// Reads the configuration from a document: tables `camera`, `odometry`, `motion`, `noise`,
/// `objects` and `filter`, in degrees and metres. Every key is checked.
/// @throws InvalidInput with file and line for a key that is unknown, missing, of a wrong type or
/// out of range
SimulationFile read_simulation(const TomlDocument& document);

}  // namespace posemix
