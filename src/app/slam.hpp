// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace posemix {

/// Adds the command `slam` to the program. If it is on the command line, parsing sets `action` to a
/// function that runs it and returns the exit code. Results have
/// words of the command line, `words`.
void add_slam_command(CLI::App& program, std::function<int()>& action,
                      const std::vector<std::string>& words);

}  // namespace posemix
