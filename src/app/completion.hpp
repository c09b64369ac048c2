// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <string>

#include "command_tree.hpp"

/// Scripts that let a shell complete commands, options and their values.
namespace posemix {

std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

/// Adds the command `completion`, which prints a script. If it is on the command line, parsing sets
/// `action` to a function that runs it and returns the exit code.
void add_completion_command(CLI::App& program, std::function<int()>& action);

}  // namespace posemix
