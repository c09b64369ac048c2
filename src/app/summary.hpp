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

/// Whether the standard output is a terminal that shows colours, and NO_COLOR is not set.
bool colours_fit_output();

/// A short table of errors, and a line on the consistency of every pose, to be read by people.
std::string format_summary(const SlamJob& job, const SlamRun& run, const Metrics& metrics,
                           bool colours);

/// Thrown when the reader of the standard output has closed it.
class BrokenPipe : public OutputError {
 public:
  BrokenPipe() : OutputError("standard output: nobody reads it any more") {}
};

/// Writes to the standard output.
/// @throws BrokenPipe when the reader has closed it, OutputError when it cannot be written
void print_text(std::string_view text);

/// Prints each warning on the standard error as `posemix: warning: ...`.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace posemix
