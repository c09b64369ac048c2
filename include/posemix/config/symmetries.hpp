// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

#include "posemix/config/toml_table.hpp"
#include "posemix/detector/symmetry.hpp"

/// Reads symmetries of objects from TOML.
namespace posemix {

/// The group of a table's keys `discrete` = [{rotation_deg, translation_m}, ...], with rotation
/// vectors in degrees, and `axes` = [{direction, point_m}, ...]; both keys are optional.
/// @throws InvalidInput `file:line: key ...`, also for symmetries that are not a group
SymmetryGroup read_symmetry_group(const TomlTable& table);

/// Groups by object id.
using SymmetryGroups = std::map<std::int64_t, SymmetryGroup>;

/// Reads the groups of a symmetry file: TOML with `schema = 1` and one table [symmetries.ID] per
/// object, with the keys of read_symmetry_group; or BOP's models_info.json, if the name ends in
/// .json.
/// @throws InvalidInput naming file and key
SymmetryGroups read_symmetry_file(const std::filesystem::path& path);

/// Reads the text of a TOML file as read_symmetry_file reads a file.
SymmetryGroups parse_symmetry_file(std::string_view text, const std::string& name);

}  // namespace posemix
