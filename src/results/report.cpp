// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/report.hpp"

#include <set>

#include <fmt/format.h>

#include "compression.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_file.hpp"
#include "report_folder.hpp"
#include "report_page.hpp"
#include "report_parts.hpp"
#include "run_files.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

std::string default_title(const fs::path& results, const ReportFolder& folder, const Json& trace) {
  switch (folder.kind) {
    case ReportKind::slam:
      return fmt::format("{}: {}", trace.at("name").get<std::string>(),
                         trace.at("method").get<std::string>());
    case ReportKind::mixture:
      return last_name(results);
    case ReportKind::consistency:
      return folder.documents.at(kConsistencyFile).at("title").get<std::string>();
    case ReportKind::salt_box:
    case ReportKind::study:
    case ReportKind::comparison:
      break;
  }
  return fmt::format("Study {}", folder.documents.at("study.json").at("study").get<std::string>());
}

std::set<std::string> objects_of(const ReportFolder& folder, const Json& trace) {
  if (folder.kind == ReportKind::slam) return trace.at("order").get<std::set<std::string>>();
  return folder.mixture_frames();
}

void require_no_camera(const ReportOptions& options) {
  if (!options.camera && !options.images) return;
  throw InvalidInput(
      "a camera, or its images, for results without a run, expected a folder of posemix slam");
}

void write_page(const fs::path& path, const std::string& data) {
  const ReportPage page = report_page();
  write_output_file(path, filled_page(inflated(page.stream, page.size), data));
}

/// A page never takes the place of results.
fs::path checked_page(const fs::path& path) {
  const fs::path end = path.extension();
  if (end == ".html" || end == ".htm") return path;
  throw InvalidInput(fmt::format("{}: got this name for the page, expected one that ends in .html",
                                 path.string()));
}

fs::path path_of_report(const fs::path& results, const ReportOptions& options) {
  if (options.out) return checked_page(*options.out);
  std::error_code error;
  if (!fs::is_regular_file(results, error)) return results / "report.html";
  return fs::path(results).replace_extension(".html");
}

}  // namespace

bool has_report_page() { return !report_page().stream.empty(); }

void require_report_page() {
  if (has_report_page()) return;
  throw OutputError(
      "a report cannot be written: this posemix was built without its page, which needs Node.js 18 "
      "and npm (CMake option POSEMIX_REPORT)");
}

std::string format_report(const fs::path& results, const ReportOptions& options) {
  if (holds_runs(results)) return format_comparison(runs_in(results), options);
  ReportFolder folder = read_report_folder(results);
  warn(folder.warnings, options);
  Json trace;
  if (folder.kind == ReportKind::slam) {
    trace = read_packed_trace(results, options);
    require_one_run(trace, folder.documents.at("metrics.json"), results);
  } else {
    require_no_camera(options);
  }
  Json report =
      report_head(folder.kind, options.title.value_or(default_title(results, folder, trace)));
  report["meshes"] = meshes_json(options, objects_of(folder, trace));
  report["documents"] = std::move(folder.documents);
  report["tables"] = std::move(folder.tables);
  report["pictures"] = std::move(folder.pictures);
  report["texts"] = std::move(folder.texts);
  if (!trace.is_null()) report["trace"] = std::move(trace);
  if (options.images) report["images"] = images_json(options);
  return json_text(report);
}

fs::path write_report(const fs::path& results, const ReportOptions& options) {
  require_report_page();
  fs::path path = path_of_report(results, options);
  write_page(path, format_report(results, options));
  return path;
}

fs::path write_comparison(const std::vector<fs::path>& runs, const ReportOptions& options) {
  require_report_page();
  fs::path path =
      options.out ? checked_page(*options.out) : common_parent(runs) / "comparison.html";
  write_page(path, format_comparison(runs, options));
  return path;
}

}  // namespace posemix
