// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

/// Exit codes of the program, for every command.
namespace posemix {

inline constexpr int kExitDone = 0;
inline constexpr int kExitInternal = 1;  ///< an error of the program itself
inline constexpr int kExitUsage = 2;     ///< an error in the command line
inline constexpr int kExitInput = 3;     ///< an error in an input file
inline constexpr int kExitOutput = 4;    ///< a file or the standard output that cannot be written
inline constexpr int kExitNetwork = 5;   ///< an error of a server or of the connection to it
/// Plus the number of the signal: 130 and 143 for an interrupt by SIGINT and SIGTERM, 141 (SIGPIPE)
/// if nobody reads the standard output any more.
inline constexpr int kExitSignal = 128;

}  // namespace posemix
