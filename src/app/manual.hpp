// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <string>

#include "command_tree.hpp"

namespace posemix {

/// The manual page of a command, for man(1). `version` is that of the program.
std::string manual_page(const CommandText& command, const std::string& version);

/// Adds the command `manual`, which writes the pages of all commands. If it is on the command line,
/// parsing sets `action` to a function that runs it and returns the exit code.
void add_manual_command(CLI::App& program, std::function<int()>& action);

}  // namespace posemix
