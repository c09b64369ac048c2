// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "posemix/io/bop.hpp"
#include "posemix/lie/lie.hpp"

/// Tables with one or several poses, such as estimate and truth, per object and image.
namespace posemix {

/// Reads the poses of one object in one scene by image id.
///
/// The table is a CSV file in which lines that start with '#' are comments. The first other line
/// names the columns, among them `scene_id`, `im_id`, `obj_id` and PREFIX`tx` ... PREFIX`qw`
/// (T_camera_object in metres, quaternion x y z w); `prefix` is "est_" for estimates and "gt_" for
/// the truth. Only the poses of selected rows are read.
/// @throws InvalidInput `name:line: got ..., expected ...`; for a second row of the same image, and
/// when no row is selected
std::map<std::int64_t, SE3d> parse_pose_table(std::string_view text, const std::string& name,
                                              BopSelection selection, const std::string& prefix);

/// Reads a file as parse_pose_table reads a text.
std::map<std::int64_t, SE3d> read_pose_table(const std::filesystem::path& path,
                                             BopSelection selection, const std::string& prefix);

/// The ids of the objects in a table, by scene.
/// @throws InvalidInput naming the file if it is not such a table
std::map<std::int64_t, std::set<std::int64_t>> read_table_objects(
    const std::filesystem::path& path);

}  // namespace posemix
