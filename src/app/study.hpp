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

/// Adds the command `study`, with one subcommand per study, to the program. If one of them is on
/// the command line, parsing sets `action` to a function that runs it and returns the exit code.
/// Results have words of the command line, `words`.
void add_study_command(CLI::App& program, std::function<int()>& action,
                       const std::vector<std::string>& words);

}  // namespace posemix
