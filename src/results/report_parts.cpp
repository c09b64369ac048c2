// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "report_parts.hpp"

#include <cmath>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compression.hpp"
#include "io/paths.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/ply.hpp"
#include "posemix/io/text.hpp"
#include "trace_pack.hpp"

namespace posemix::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kReportSchema = 1;

const char* kind_name(ReportKind kind) {
  static constexpr const char* kNames[] = {"slam",  "mixture",     "salt_box",
                                           "study", "consistency", "comparison"};
  return kNames[static_cast<std::size_t>(kind)];
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

Json intrinsics_json(const ReportCamera& camera) {
  const bool focal = camera.fx > 0.0 && camera.fy > 0.0 && std::isfinite(camera.fx + camera.fy);
  const bool size = camera.width > 0 && camera.height > 0;
  if (!focal || !size || !std::isfinite(camera.cx + camera.cy)) {
    throw InvalidInput(
        fmt::format("camera: got fx {}, fy {}, cx {}, cy {}, {} x {} pixels, expected positive "
                    "focal lengths and sizes",
                    camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height));
  }
  return {{"fx", camera.fx}, {"fy", camera.fy},       {"cx", camera.cx},
          {"cy", camera.cy}, {"width", camera.width}, {"height", camera.height}};
}

}  // namespace

void warn(const std::vector<std::string>& warnings, const ReportOptions& options) {
  if (!options.warn) return;
  for (const std::string& warning : warnings) options.warn(warning);
}

std::string last_name(const fs::path& path) {
  const fs::path absolute = absolute_path(path);
  return (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string();
}

Json report_head(ReportKind kind, const std::string& title) {
  return {{"schema", kReportSchema},
          {"type", "posemix.report"},
          {"kind", kind_name(kind)},
          {"title", title},
          {"program", "posemix " POSEMIX_VERSION}};
}

Json read_packed_trace(const fs::path& folder, const ReportOptions& options) {
  const fs::path path = folder / "trace.json";
  std::ifstream text(path, std::ios::binary);
  std::error_code error;
  const auto size = static_cast<std::size_t>(fs::file_size(path, error));
  if (!text || error) throw InvalidInput(fmt::format("{}: cannot be read", path.string()));
  PackedTrace packed = pack_trace(text, path.string(), [&](std::size_t done) {
    if (options.progress) options.progress(done, size);
  });
  warn(packed.warnings, options);
  if (options.camera) packed.columns["intrinsics"] = intrinsics_json(*options.camera);
  return std::move(packed.columns);
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

fs::path common_parent(const std::vector<fs::path>& paths) {
  std::set<fs::path> parents;
  for (const fs::path& path : paths) {
    fs::path absolute = absolute_path(path);
    if (!absolute.has_filename()) absolute = absolute.parent_path();
    parents.insert(absolute.parent_path());
  }
  if (parents.size() == 1) return *parents.begin();
  throw InvalidInput(
      "got runs of several folders, expected those of one, or where to write the page (--out)");
}

}  // namespace posemix::internal
