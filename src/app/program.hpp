// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

namespace posemix {

/// The program: parses the command line, runs the command, and turns every error into one line on
/// the standard error and an exit code (exit_codes.hpp).
int run_program(int argc, const char* const* argv);

}  // namespace posemix
