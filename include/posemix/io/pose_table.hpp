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

/// Tables with one pose, or several kinds of poses, per object and image.
namespace posemix {

/// The poses of one object in one scene by image id.
///
/// CSV; lines that start with '#' are comments, the first other line names the columns, of which
/// `scene_id`, `im_id`, `obj_id` and PREFIX`tx` ... PREFIX`qw` (T_camera_object, metres and a
/// quaternion x y z w) must be there; `prefix` is "est_" for estimates and "gt_" for the truth.
/// Only the poses of selected rows are looked at.
/// @throws InvalidInput `name:line: got ..., expected ...`; for a second row of the same image, and
/// when no row is selected
std::map<std::int64_t, SE3d> parse_pose_table(std::string_view text, const std::string& name,
                                              BopSelection selection, const std::string& prefix);

/// As parse_pose_table, for a file.
std::map<std::int64_t, SE3d> read_pose_table(const std::filesystem::path& path,
                                             BopSelection selection, const std::string& prefix);

/// The ids of the objects in a table, by scene.
/// @throws InvalidInput naming the file that is not such a table
std::map<std::int64_t, std::set<std::int64_t>> read_table_objects(
    const std::filesystem::path& path);

}  // namespace posemix
