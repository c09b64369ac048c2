// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "posemix/results/report.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace posemix {

class InterruptGuard;

/// Adds the command `report` to the program. If it is on the command line, parsing sets `action` to
/// a function that runs it and returns the exit code.
void add_report_command(CLI::App& program, std::function<int()>& action);

/// Calls write_report, or of several results write_comparison, with a progress bar if `shown`; a
/// signal stops it.
std::filesystem::path write_report_shown(const std::vector<std::filesystem::path>& results,
                                         ReportOptions options, bool shown,
                                         const InterruptGuard& guard);

/// The URL file:///... of a path, for a browser.
std::string file_url(const std::filesystem::path& path);

}  // namespace posemix
