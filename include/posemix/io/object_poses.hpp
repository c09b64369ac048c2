// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "posemix/lie/lie.hpp"

/// Static object poses: one line `id tx ty tz qx qy qz qw` per object, in metres and a unit
/// quaternion.
namespace posemix {

/// The poses T_world_object of a text by object id (any word); at least one.
///
/// Blank lines and lines that start with '#' are skipped; numbers after qw are ignored. Throws
/// InvalidInput `name:line: got ..., expected ...` for anything else than an id and at least seven
/// finite numbers, for a quaternion that is not of norm one within 1e-2, and for an id that stands
/// twice.
std::map<std::string, SE3d> parse_object_poses(std::string_view text, const std::string& name);

/// As parse_object_poses, for a file.
std::map<std::string, SE3d> read_object_poses(const std::filesystem::path& path);

/// The text of object poses, 12 significant digits.
std::string format_object_poses(const std::map<std::string, SE3d>& poses);

}  // namespace posemix
