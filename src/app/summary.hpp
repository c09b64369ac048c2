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

/// A short table of errors and consistency, to be read by people.
std::string format_summary(const SlamJob& job, const Metrics& metrics);

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
