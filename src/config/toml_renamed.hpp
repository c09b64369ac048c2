// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "toml_node.hpp"

/// Keys that had another name in the previous release. They are read for one release, with a
/// warning.
namespace posemix::internal {

/// The new name of the key `key` in the document's table at `path` (the keys that lead to it);
/// empty if the key has not been renamed.
std::string_view new_toml_name(const TomlState& state, const std::vector<std::string>& path,
                               std::string_view key);

/// Renames the old keys of a document and adds a warning with the place of each to its warnings.
/// @throws InvalidInput when a table has a key under both names
void rename_old_keys(TomlState& state);

/// Renames the old keys in the path to a value and returns whether there was one.
bool rename_old_path(const TomlState& state, std::vector<std::string>& path);

}  // namespace posemix::internal
