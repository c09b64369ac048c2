// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "posemix/results/provenance.hpp"
#include "posemix/slam/job.hpp"

namespace posemix {

/// The words of the command line, with the program's name alone in place of its path.
std::vector<std::string> command_words(int argc, const char* const* argv);

/// Where the results of a run come from: its document has been read, and `file` is its path.
Provenance run_provenance(const std::vector<std::string>& command, const std::string& file,
                          const std::vector<std::string>& overrides, const TomlDocument& document,
                          const SlamJob& job);

/// Where the results of a study come from: its settings as JSON, and the file with some of them, or
/// an empty path.
Provenance study_provenance(const std::vector<std::string>& command, const std::string& settings,
                            const std::string& file);

}  // namespace posemix
