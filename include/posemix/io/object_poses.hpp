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

/// Reads the poses T_world_object of a text by object id (any word); at least one.
///
/// Blank lines and lines that start with '#' are skipped; numbers after qw are ignored.
/// @throws InvalidInput `name:line: got ..., expected ...` for a line that is not an id and at
/// least seven finite numbers, a quaternion whose norm differs from one by more than 1e-2, and an
/// id that occurs twice
std::map<std::string, SE3d> parse_object_poses(std::string_view text, const std::string& name);

/// Reads a file as parse_object_poses reads a text.
std::map<std::string, SE3d> read_object_poses(const std::filesystem::path& path);

/// The text of object poses, with 12 significant digits.
std::string format_object_poses(const std::map<std::string, SE3d>& poses);

}  // namespace posemix
