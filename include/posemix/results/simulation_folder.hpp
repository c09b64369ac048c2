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
/// line of zeros for a miss) and `truth_<id>.tum` (T_camera_object). An object that moves or is not
/// always there has `world_truth_<id>.tum` (T_world_object) too, and a frame `frame_<name>.tum` as
/// it is told and `frame_truth_<name>.tum`. Where detections name a class or may be false,
/// `observations.csv` has all of them in place of `detections_<id>.tum`, and `sources.csv` of which
/// object each is. Poses have nine decimals,
/// which are the digits of SimulatedPose: the same simulation gives the same bytes on any machine.
/// @throws InvalidInput where there would be observations but nothing is ever detected, and as
/// validate for a recording
std::map<std::string, std::string> format_simulation(const SimulationFile& file,
                                                     const SimulatedSequence& simulated,
                                                     std::uint64_t seed);

}  // namespace posemix
