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
/// server. docs/formats.md describes its content.
namespace posemix {

/// A triangle mesh of an object, in the object's frame.
struct ReportMesh {
  std::filesystem::path ply;
  double unit_m = 1.0;  ///< length of the file's unit: 1e-3 for BOP's models
};

struct ReportOptions {
  /// The file to write. By default report.html in the results folder, and for a mixture file
  /// FILE.json the file FILE.html beside it.
  std::optional<std::filesystem::path> out = std::nullopt;
  /// Meshes by object id.
  std::map<std::string, ReportMesh> meshes = {};
  /// Title of the page. By default it is taken from the results.
  std::optional<std::string> title = std::nullopt;
  /// Called now and then with the number of bytes of the trace read so far and in all; an exception
  /// that it throws ends the work.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
  /// Called with a warning for every key that a file has under the name of the release before.
  std::function<void(const std::string& warning)> warn = {};
};

/// Whether this build of the library includes the page (CMake option POSEMIX_REPORT). Without the
/// page, write_report throws.
bool has_report_page();
/// Does nothing if this build includes the page.
/// @throws OutputError otherwise, naming what is missing
void require_report_page();

/// The data of the page, as JSON (docs/formats.md, report.html).
///
/// `results` is a folder that `posemix slam` or `posemix study` wrote, a folder of mixture files,
/// or one mixture file. For a trace, memory holds the JSON and the columns of one object.
/// @throws InvalidInput naming the file and the place in it: a folder without results, with the
/// names of folders within that have some; a damaged file; a mesh for an unknown object
std::string format_report(const std::filesystem::path& results, const ReportOptions& options = {});

/// Writes the report of a results folder as a whole or not at all, and returns its path.
/// @throws InvalidInput as format_report
/// @throws OutputError where the report cannot be written, and as require_report_page
std::filesystem::path write_report(const std::filesystem::path& results,
                                   const ReportOptions& options = {});

}  // namespace posemix
