// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "posemix/config/simulation_config.hpp"

/// A simulated recording as files that `posemix slam` reads.
namespace posemix {

/// The files of a simulated recording by name: `sequence.toml`, `odometry.tum` (T_odom_camera),
/// `camera_truth.tum` (T_world_camera), and per object `detections_<id>.tum` (T_camera_object, a
/// line of zeros for a miss) and `truth_<id>.tum` (T_camera_object). Poses have nine decimals,
/// which are the digits of SimulatedPose: the same simulation gives the same bytes on any machine.
std::map<std::string, std::string> format_simulation(const SimulationFile& file,
                                                     const SimulatedSequence& simulated,
                                                     std::uint64_t seed);

}  // namespace posemix
