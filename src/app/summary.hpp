// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "posemix/config/sequence_file.hpp"
#include "posemix/io/output_folder.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix {

/// A short table of errors and consistency for people.
std::string format_summary(const SlamJob& job, const Metrics& metrics);

/// Nobody reads the standard output any more.
class BrokenPipe : public OutputError {
 public:
  BrokenPipe() : OutputError("standard output: nobody reads it any more") {}
};

/// Writes to the standard output.
/// @throws BrokenPipe when its reader has gone, OutputError when it cannot be written
void print_text(std::string_view text);

/// Prints `posemix: warning: ...` on the standard error for each.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace posemix
