// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/renamed.hpp"
#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "toml_node.hpp"
#include "toml_renamed.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kMostParts = 16;

struct Override {
  std::string origin;  ///< "--set key=value"
  std::vector<std::string> path;
  std::string value;

  [[noreturn]] void fail(std::string_view message) const {
    throw InvalidInput(fmt::format("{}: {}", origin, message));
  }
};

bool is_bare(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

/// Takes one part of a path, bare or quoted, from the front of `text`.
std::string take_part(std::string_view& text, const Override& error) {
  std::string part;
  if (text.starts_with('"')) {
    const std::size_t end = text.find('"', 1);
    if (end == std::string_view::npos) error.fail("got a key without its closing quote");
    part = text.substr(1, end - 1);
    text.remove_prefix(end + 1);
  } else {
    std::size_t size = 0;
    while (size < text.size() && is_bare(text[size])) ++size;
    part = text.substr(0, size);
    text.remove_prefix(size);
  }
  if (part.empty())
    error.fail("got an empty part of the key, expected key=value as in filter.gate=0.99");
  return part;
}

Override parse_override(std::string_view assignment) {
  Override result;
  const std::string shown = in_quotes(assignment, 80);
  result.origin = "--set " + shown.substr(1, shown.size() - 2);
  std::string_view rest = assignment;
  result.path.push_back(take_part(rest, result));
  while (rest.starts_with('.')) {
    rest.remove_prefix(1);
    result.path.push_back(take_part(rest, result));
  }
  if (!rest.starts_with('=')) result.fail("got no '=' after the key, expected key=value");
  if (result.path.size() > kMostParts) {
    result.fail(fmt::format("got {} parts in the key, expected at most {}", result.path.size(),
                            kMostParts));
  }
  result.value = rest.substr(1);
  return result;
}

void mark(TomlNode& node, const Override& source) {
  node.origin = source.origin;
  node.raw = source.value;
  for (TomlNode& child : node.children) {
    mark(child, source);
    child.raw.clear();
  }
}

TomlNode& element(TomlNode& array, const std::string& part, std::string_view path,
                  const Override& source) {
  if (const auto index = parse_integer(part)) {
    const auto position = static_cast<std::size_t>(*index);
    if (*index >= 0 && position < array.children.size()) return array.children[position];
    source.fail(fmt::format("got index {} in '{}', expected 0 to {}", *index, path,
                            static_cast<std::ptrdiff_t>(array.children.size()) - 1));
  }
  for (TomlNode& item : array.children) {
    const TomlNode* id = item.find("id");
    if (id != nullptr && id->kind == TomlKind::string && id->string == part) return item;
  }
  source.fail(fmt::format("got '{}' in '{}', expected an index or the id of one of its tables",
                          part, path));
}

TomlNode& entry(TomlNode& table, const std::string& part, const Override& source) {
  if (TomlNode* present = table.find(part)) return *present;
  table.keys.push_back(part);
  table.children.emplace_back();
  table.children.back().origin = source.origin;
  return table.children.back();
}

std::string dotted(const std::vector<std::string>& path) {
  return fmt::format("{}", fmt::join(path, "."));
}

}  // namespace

std::string join_toml_path(std::string_view parent, std::string_view key) {
  return parent.empty() ? std::string(key) : fmt::format("{}.{}", parent, key);
}

std::vector<std::string> override_path(std::string_view assignment) {
  return parse_override(assignment).path;
}

void apply_toml_override(TomlState& state, std::string_view assignment) {
  Override source = parse_override(assignment);
  const std::string given = dotted(source.path);
  if (rename_old_path(state, source.path)) {
    state.warnings.push_back(renamed_warning(source.origin, "key", given, dotted(source.path)));
  }
  TomlNode* node = &state.root;
  std::string path;
  for (const std::string& part : source.path) {
    if (node->kind == TomlKind::array) {
      node = &element(*node, part, path, source);
    } else if (node->kind == TomlKind::table) {
      node = &entry(*node, part, source);
    } else {
      source.fail(fmt::format("key '{}' {}, expected a table", path, describe_toml_value(*node)));
    }
    path = join_toml_path(path, part);
  }
  const std::size_t line = node->line;
  *node = parse_toml_value(source.value);
  node->line = line;
  mark(*node, source);
  rename_old_keys(state);
}

}  // namespace posemix::internal
