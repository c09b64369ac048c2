// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>

#include "posemix/io/sequence_file.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix {

/// A short table of errors and consistency for people.
std::string format_summary(const SlamJob& job, const Metrics& metrics);

/// Writes to the standard output. @throws OutputError when that is not possible
void print_text(std::string_view text);

}  // namespace posemix
