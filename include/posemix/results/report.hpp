// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

/// Reports: one HTML file that shows a folder of results in a browser, without a network or a
/// server. docs/formats.md describes what it holds.
namespace posemix {

/// A triangle mesh of an object, in the object's frame.
struct ReportMesh {
  std::filesystem::path ply;
  double unit_m = 1.0;  ///< length of the file's unit: 1e-3 for BOP's models
};

struct ReportOptions {
  /// Where the report is written; without it report.html in the results folder, and for a mixture
  /// file FILE.json beside it FILE.html.
  std::optional<std::filesystem::path> out = std::nullopt;
  /// By object id.
  std::map<std::string, ReportMesh> meshes = {};
  /// Without it, from the results.
  std::optional<std::string> title = std::nullopt;
  /// Told now and then how many bytes of the trace have been read, of how many; what it throws ends
  /// the work.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
  /// Called with a warning for every key that a file has under the name of the release before.
  std::function<void(const std::string& warning)> warn = {};
};

/// Whether this build of the library holds the page (CMake option POSEMIX_REPORT). Without it
/// write_report throws.
bool has_report_page();
/// @throws OutputError where it does not, with what is missing
void require_report_page();

/// What the page shows, as JSON (docs/formats.md, report.html).
///
/// `results` is a folder that `posemix slam` or `posemix study` wrote, a folder of mixture files,
/// or one mixture file. Of a trace as much is in memory as the JSON takes, and the columns of one
/// object.
/// @throws InvalidInput naming the file and the place in it: a folder without results, which names
/// the folders within that have some; a damaged file; a mesh for an object that is not there
std::string format_report(const std::filesystem::path& results, const ReportOptions& options = {});

/// Writes the report of a results folder as a whole or not at all, and returns its path.
/// @throws InvalidInput as format_report
/// @throws OutputError where the report cannot be written, and as require_report_page
std::filesystem::path write_report(const std::filesystem::path& results,
                                   const ReportOptions& options = {});

}  // namespace posemix
