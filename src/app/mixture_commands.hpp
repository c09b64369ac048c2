// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

/// The commands on mixture files and on saved states. Each function adds one to the program; if it
/// is on the command line, parsing sets `action` to a function that runs it and returns the exit
/// code.
namespace posemix {

void add_compose_command(CLI::App& program, std::function<int()>& action);
void add_consistency_command(CLI::App& program, std::function<int()>& action);
void add_convert_command(CLI::App& program, std::function<int()>& action);
void add_density_command(CLI::App& program, std::function<int()>& action);
void add_divergence_command(CLI::App& program, std::function<int()>& action);
void add_fit_command(CLI::App& program, std::function<int()>& action);
void add_fuse_command(CLI::App& program, std::function<int()>& action);
void add_fuse_views_command(CLI::App& program, std::function<int()>& action);
void add_grasp_command(CLI::App& program, std::function<int()>& action);
void add_reduce_command(CLI::App& program, std::function<int()>& action);
void add_relocalise_command(CLI::App& program, std::function<int()>& action);
void add_sample_command(CLI::App& program, std::function<int()>& action);
void add_state_command(CLI::App& program, std::function<int()>& action);

}  // namespace posemix
