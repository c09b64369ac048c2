// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

#include "posemix/config/toml_table.hpp"
#include "posemix/detector/symmetry.hpp"

/// Symmetries of objects as TOML writes them.
namespace posemix {

/// The group of a table's keys `discrete` = [{rotation_deg, translation_m}, ...], rotation vectors
/// in degrees, and `axes` = [{direction, point_m}, ...]; none of them is needed.
/// @throws InvalidInput `file:line: key ...`, also for a set that is no group
SymmetryGroup read_symmetry_group(const TomlTable& table);

/// Groups by object id.
using SymmetryGroups = std::map<std::int64_t, SymmetryGroup>;

/// The groups of a symmetry file: TOML with `schema = 1` and one table [symmetries.ID] per object,
/// with the keys of read_symmetry_group; or, where the name ends in .json, BOP's models_info.json.
/// @throws InvalidInput naming file and key
SymmetryGroups read_symmetry_file(const std::filesystem::path& path);

/// As read_symmetry_file for the text of a TOML file.
SymmetryGroups parse_symmetry_file(std::string_view text, const std::string& name);

}  // namespace posemix
