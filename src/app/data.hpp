// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace posemix {

/// Adds the command `data` and its subcommands to the program. If one of them is on the command
/// line, parsing sets `action` to a function that runs it and returns the exit code.
void add_data_command(CLI::App& program, std::function<int()>& action);

/// Add the subcommands of `data`, one source file each.
void add_data_list_command(CLI::App& data, std::function<int()>& action);
void add_data_fetch_command(CLI::App& data, std::function<int()>& action);
void add_data_verify_command(CLI::App& data, std::function<int()>& action);
void add_data_sequence_command(CLI::App& data, std::function<int()>& action);

}  // namespace posemix
