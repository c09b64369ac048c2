// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/config/simulation_config.hpp"
#include "sequence_parts.hpp"

/// The parts of a simulation file.
namespace posemix::internal {

inline constexpr IntegerRange kSimulationCount{.lowest = 0, .highest = 10'000'000};
inline constexpr NumberRange kSimulationTime{.lowest = 0, .highest = 1e6};
inline constexpr NumberRange kSimulationLength{.lowest = -1e3, .highest = 1e3};
inline constexpr NumberRange kSimulationBox{.lowest = 0, .highest = 1e3};
inline constexpr NumberRange kSimulationAngleDeg{.lowest = -360, .highest = 360};

Eigen::Vector3d get_vector3(const TomlTable& table, std::string_view key,
                            const Eigen::Vector3d& otherwise);
/// A rotation vector, in degrees in the file and in radians in the result.
Eigen::Vector3d get_rotation(const TomlTable& table, std::string_view key);
/// Standard deviations under `rotation_sd_deg`, and `translation_sd_m` or, along the viewing ray,
/// `translation_sd_of_range`.
SimulationSd get_sd(const TomlTable& table, const SimulationSd& otherwise,
                    NoiseFrame frame = NoiseFrame::object);
SimulationRuns get_runs(const TomlTable& table);
/// A name under a key, of letters, digits, '_', '.' and '-'.
std::string get_name(const TomlTable& table, std::string_view key);

/// Reads when an object is there and how it moves.
void get_motions(const TomlTable& table, SimulationObject& object);
/// Reads `camera.view`.
std::optional<SimulationView> get_view(const TomlTable& camera);
/// Reads the tables `frames` and `clutter`.
std::vector<SimulationFrame> get_frames(const TomlTable& root);
std::vector<SimulationClutter> get_clutter(const TomlTable& root);

}  // namespace posemix::internal
