// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <functional>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace posemix {

/// Adds the command `live` to the program. If it is on the command line, parsing sets `action` to a
/// function that runs it and returns the exit code.
void add_live_command(CLI::App& program, std::function<int()>& action);

}  // namespace posemix
