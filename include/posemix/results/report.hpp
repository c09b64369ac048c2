// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Reports: one HTML file that shows a folder of results in a browser, without a network or a
/// server. docs/formats.md describes its content.
namespace posemix {

/// A triangle mesh of an object, in the object's frame.
struct ReportMesh {
  std::filesystem::path ply;
  double unit_m = 1.0;  ///< length of the file's unit: 1e-3 for BOP's models
};

/// The intrinsics of the camera whose poses a run has, in pixels, without distortion: a point
/// (x, y, z) of the camera's frame is at (fx x / z + cx, fy y / z + cy).
struct ReportCamera {
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/// Pictures of the camera: the JPEG and PNG files of a folder, which go into the page as they are.
struct ReportImages {
  /// Their stamps [s] are those of `stamps.csv` in it, with the columns `name,stamp_s`; without
  /// that file the number in a name, in seconds, or in nanoseconds where it has 16 or more digits.
  std::filesystem::path folder;
  /// Where there are more bytes, every n-th picture is taken, and that is a warning.
  std::size_t most_bytes = 8'000'000;
};

struct ReportOptions {
  /// The file to write. By default report.html in the results folder, and for a mixture file
  /// FILE.json the file FILE.html beside it.
  std::optional<std::filesystem::path> out = std::nullopt;
  /// Meshes by object id.
  std::map<std::string, ReportMesh> meshes = {};
  /// Of a run, or of every run of a comparison.
  std::optional<ReportCamera> camera = std::nullopt;
  std::optional<ReportImages> images = std::nullopt;
  /// Title of the page. By default it is taken from the results.
  std::optional<std::string> title = std::nullopt;
  /// Called now and then with the number of bytes of the trace read so far and in all; an exception
  /// that it throws ends the work.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
  /// Called with a warning for every key that a file has under the name of the release before, for
  /// every file that is left out as it is not of the run, and for what would make a page too large.
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
/// or one mixture file. For a trace, memory holds the JSON and the columns of one object. Of a
/// folder without results in which there are several runs, it is format_comparison of these.
/// @throws InvalidInput naming the file and the place in it: a folder without results, with the
/// names of folders within that have some; a damaged file; trace.json and metrics.json of two runs;
/// a mesh for an unknown object
std::string format_report(const std::filesystem::path& results, const ReportOptions& options = {});

/// The data of a page that compares runs, at least two, over the same recording.
/// @throws InvalidInput as format_report, and for runs that have no frame, or no object, in common,
/// or one of which has frames between those of another
std::string format_comparison(const std::vector<std::filesystem::path>& runs,
                              const ReportOptions& options = {});

/// Writes the report of a results folder as a whole or not at all, and returns its path.
/// @throws InvalidInput as format_report
/// @throws OutputError where the report cannot be written, and as require_report_page
std::filesystem::path write_report(const std::filesystem::path& results,
                                   const ReportOptions& options = {});

/// Writes the page that compares runs, by default as comparison.html in the folder that all of them
/// are in.
/// @throws InvalidInput as format_comparison, and where there is no such folder
/// @throws OutputError as write_report
std::filesystem::path write_comparison(const std::vector<std::filesystem::path>& runs,
                                       const ReportOptions& options = {});

}  // namespace posemix
