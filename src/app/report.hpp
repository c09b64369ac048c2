// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "posemix/results/report.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace posemix {

class InterruptGuard;

/// Adds the command `report` to the program. When it is on the command line, parsing sets `action`
/// to what it does; the result of `action` is the exit code.
void add_report_command(CLI::App& program, std::function<int()>& action);

/// write_report with a progress bar where `shown`, until a signal.
std::filesystem::path write_report_shown(const std::filesystem::path& results,
                                         ReportOptions options, bool shown,
                                         const InterruptGuard& guard);

/// file:///... of a path, for a browser.
std::string file_url(const std::filesystem::path& path);

}  // namespace posemix
