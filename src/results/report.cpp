// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/results/report.hpp"

#include <cstring>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compression.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/output_file.hpp"
#include "posemix/io/ply.hpp"
#include "posemix/io/text.hpp"
#include "report_folder.hpp"
#include "report_page.hpp"
#include "trace_pack.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

constexpr int kReportSchema = 1;

const char* kind_name(ReportKind kind) {
  static constexpr const char* kNames[] = {"slam", "mixture", "salt_box", "study", "consistency"};
  return kNames[static_cast<std::size_t>(kind)];
}

void warn(const std::vector<std::string>& warnings, const ReportOptions& options) {
  if (!options.warn) return;
  for (const std::string& warning : warnings) options.warn(warning);
}

Json read_trace(const fs::path& path, const ReportOptions& options) {
  std::ifstream text(path, std::ios::binary);
  std::error_code error;
  const auto size = static_cast<std::size_t>(fs::file_size(path, error));
  if (!text || error) throw InvalidInput(fmt::format("{}: cannot be read", path.string()));
  PackedTrace packed = pack_trace(text, path.string(), [&](std::size_t done) {
    if (options.progress) options.progress(done, size);
  });
  warn(packed.warnings, options);
  return std::move(packed.columns);
}

/// Name of the last part of a path that has one.
std::string last_name(const fs::path& path) {
  const fs::path absolute = fs::absolute(path).lexically_normal();
  return (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string();
}

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
      break;
  }
  return fmt::format("Study {}", folder.documents.at("study.json").at("study").get<std::string>());
}

std::set<std::string> objects_of(const ReportFolder& folder, const Json& trace) {
  if (folder.kind == ReportKind::slam) return trace.at("order").get<std::set<std::string>>();
  return folder.mixture_frames();
}

template <typename Number>
void append_number(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

Json mesh_json(const ReportMesh& file) {
  const PlyMesh mesh = read_ply_mesh(file.ply, file.unit_m);
  std::string vertices;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    for (const double value : vertex) append_number(vertices, static_cast<float>(value));
  }
  std::string triangles;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) append_number(triangles, corner);
  }
  return {{"vertices", base64(vertices)}, {"triangles", base64(triangles)}};
}

Json meshes_json(const ReportOptions& options, const std::set<std::string>& objects) {
  Json meshes = Json::object();
  for (const auto& [id, mesh] : options.meshes) {
    if (!objects.contains(id)) {
      throw InvalidInput(fmt::format(
          "{}: got a mesh for the object {}, expected one for {}", mesh.ply.string(), in_quotes(id),
          objects.empty() ? "none" : fmt::format("{}", fmt::join(objects, ", "))));
    }
    meshes[id] = mesh_json(mesh);
  }
  return meshes;
}

fs::path path_of_report(const fs::path& results, const ReportOptions& options) {
  if (options.out) return *options.out;
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
  ReportFolder folder = read_report_folder(results);
  warn(folder.warnings, options);
  Json trace;
  if (folder.kind == ReportKind::slam) trace = read_trace(results / "trace.json", options);
  Json report = {{"schema", kReportSchema},
                 {"type", "posemix.report"},
                 {"kind", kind_name(folder.kind)},
                 {"title", options.title.value_or(default_title(results, folder, trace))},
                 {"program", "posemix " POSEMIX_VERSION},
                 {"meshes", meshes_json(options, objects_of(folder, trace))}};
  report["documents"] = std::move(folder.documents);
  report["tables"] = std::move(folder.tables);
  report["pictures"] = std::move(folder.pictures);
  report["texts"] = std::move(folder.texts);
  if (!trace.is_null()) report["trace"] = std::move(trace);
  return json_text(report);
}

fs::path write_report(const fs::path& results, const ReportOptions& options) {
  require_report_page();
  const ReportPage page = report_page();
  const std::string data = format_report(results, options);
  fs::path path = path_of_report(results, options);
  write_output_file(path, filled_page(inflated(page.stream, page.size), data));
  return path;
}

}  // namespace posemix
