// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/pose_table.hpp"

#include <fmt/format.h>

#include "csv_table.hpp"
#include "posemix/base/error.hpp"

namespace posemix {

using namespace internal;

std::map<std::int64_t, SE3d> parse_pose_table(std::string_view text, const std::string& name,
                                              BopSelection selection, const std::string& prefix) {
  CsvTable table(text, name);
  for (const char* column : {"scene_id", "im_id", "obj_id"}) table.require_column(column);
  table.require_pose(prefix);
  std::map<std::int64_t, SE3d> poses;
  while (table.next()) {
    const std::int64_t scene = table.index("scene_id");
    const std::int64_t object = table.index("obj_id");
    const std::int64_t image = table.index("im_id");
    const bool selected = scene == selection.scene && object == selection.object;
    if (!selected || poses.emplace(image, table.pose(prefix)).second) continue;
    table.reader().fail(fmt::format("object {} in image {} of scene {} again", selection.object,
                                    image, selection.scene),
                        "one row per object and image");
  }
  if (!poses.empty()) return poses;
  throw InvalidInput(fmt::format("{}: got no row of scene {} and object {}, expected at least one",
                                 name, selection.scene, selection.object));
}

std::map<std::int64_t, SE3d> read_pose_table(const std::filesystem::path& path,
                                             BopSelection selection, const std::string& prefix) {
  return parse_pose_table(read_file(path), path.string(), selection, prefix);
}

std::map<std::int64_t, std::set<std::int64_t>> read_table_objects(
    const std::filesystem::path& path) {
  const std::string text = read_file(path);
  CsvTable table(text, path.string());
  for (const char* column : {"scene_id", "obj_id"}) table.require_column(column);
  std::map<std::int64_t, std::set<std::int64_t>> objects;
  while (table.next()) objects[table.index("scene_id")].insert(table.index("obj_id"));
  return objects;
}

}  // namespace posemix
