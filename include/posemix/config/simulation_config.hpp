// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "posemix/slam/simulation.hpp"

/// Reading the configuration of `posemix simulate`.
namespace posemix {

/// The content of a simulation file.
struct SimulationFile {
  SimulationConfig config;
  /// The table [filter] for the sequence file: keys, and values as TOML writes them.
  std::vector<std::pair<std::string, std::string>> filter;
};

/// The configuration in a document: tables `camera`, `odometry`, `motion`, `noise`, `objects` and
/// `filter`, degrees and metres. Every key is checked: throws InvalidInput with file and line for
/// one that is unknown, missing, of a wrong type or out of range.
SimulationFile read_simulation(const TomlDocument& document);

}  // namespace posemix
