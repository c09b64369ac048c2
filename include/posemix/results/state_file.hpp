// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>

#include "posemix/slam/state.hpp"

/// Files of saved states (docs/state.md): the bytes of posemix::state_bytes.
namespace posemix {

/// Writes the state of a tracker. The file appears, or replaces an older one, as a whole or not at
/// all (write_output_file).
/// @throws OutputError naming the path and the reason
void save_state(const std::filesystem::path& path, const MultiObjectSlam& slam);
void save_state(const std::filesystem::path& path, const StampedSlam& slam);
/// @throws InvalidInput also for a tracker that is not MultiObjectSlam
void save_state(const std::filesystem::path& path, const ObjectSlam& slam);

/// @throws InvalidInput with the path, as slam_of_state, and when the file cannot be read
SlamState load_state(const std::filesystem::path& path);

/// What the head of the file says of it.
/// @throws InvalidInput with the path, as state_info, and when the file cannot be read
StateInfo read_state_info(const std::filesystem::path& path);

}  // namespace posemix
