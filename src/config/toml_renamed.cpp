// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "toml_renamed.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/renamed.hpp"
#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

/// A part of a path that fits any key.
constexpr std::string_view kAnyKey = "*";

struct RenamedKey {
  std::string_view table;  ///< a path of at most two keys
  std::string_view old_name;
  std::string_view new_name;
};

constexpr std::array kRenamedKeys{
    RenamedKey{"noise.*", "null", "clutter"},
};

/// Whether the keys of a path fit a pattern, in which `*` fits any key.
bool fits(const std::vector<std::string>& path, std::string_view pattern) {
  for (const std::string& key : path) {
    const std::size_t end = std::min(pattern.find('.'), pattern.size());
    const std::string_view part = pattern.substr(0, end);
    if (part.empty() || (part != kAnyKey && part != key)) return false;
    pattern.remove_prefix(std::min(end + 1, pattern.size()));
  }
  return pattern.empty();
}

std::string joined(const std::vector<std::string>& path, std::string_view key) {
  return join_toml_path(fmt::format("{}", fmt::join(path, ".")), key);
}

void rename_in(TomlState& state, TomlNode& table, std::vector<std::string>& path) {
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    const std::string old_name = table.keys[i];
    const std::string new_name(new_toml_name(state, path, old_name));
    TomlNode& node = table.children[i];
    if (!new_name.empty()) {
      if (const TomlNode* other = table.find(new_name)) {
        state.fail(node, fmt::format("key '{}' is the old name of '{}', which is at {} already, "
                                     "expected one of them",
                                     joined(path, old_name), joined(path, new_name),
                                     state.location(*other)));
      }
      table.keys[i] = new_name;
      state.warnings.push_back(renamed_warning(state.location(node), "key", joined(path, old_name),
                                               joined(path, new_name)));
    }
    if (node.kind != TomlKind::table) continue;
    path.push_back(table.keys[i]);
    rename_in(state, node, path);
    path.pop_back();
  }
}

}  // namespace

std::string_view new_toml_name(const TomlState& state, const std::vector<std::string>& path,
                               std::string_view key) {
  if (path.empty()) {
    const auto found = state.renamed.find(key);
    return found == state.renamed.end() ? std::string_view() : found->second;
  }
  for (const RenamedKey& renamed : kRenamedKeys) {
    if (renamed.old_name == key && fits(path, renamed.table)) return renamed.new_name;
  }
  return {};
}

void rename_old_keys(TomlState& state) {
  std::vector<std::string> path;
  rename_in(state, state.root, path);
}

bool rename_old_path(const TomlState& state, std::vector<std::string>& path) {
  bool renamed = false;
  std::vector<std::string> table;
  for (std::string& key : path) {
    if (const std::string_view name = new_toml_name(state, table, key); !name.empty()) {
      key = name;
      renamed = true;
    }
    table.push_back(key);
  }
  return renamed;
}

}  // namespace posemix::internal
