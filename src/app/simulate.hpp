// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace posemix {

/// Adds the command `simulate` to the program. When it is on the command line, parsing sets
/// `action` to what it does; the result of `action` is the exit code.
void add_simulate_command(CLI::App& program, std::function<int()>& action);

}  // namespace posemix
