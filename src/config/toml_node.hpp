// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// The tree of a TOML document, independent of the parsing library.
namespace posemix::internal {

enum class TomlKind { boolean, integer, number, string, date, array, table };

/// A value and the place where it was written.
struct TomlNode {
  TomlKind kind = TomlKind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0;
  std::string string;
  /// For a table: one key for each child, in the order of the text.
  std::vector<std::string> keys;
  std::vector<TomlNode> children;  ///< for a table or an array
  std::size_t line = 1;
  std::string origin;  ///< "--set key=value" for an override, empty for a value of the file
  std::string raw;     ///< the text after '=' in an override
  /// The keys of a table that getters were called for.
  mutable std::set<std::string, std::less<>> known;

  /// The child under `key`, or null.
  const TomlNode* find(std::string_view key) const;
  TomlNode* find(std::string_view key);
};

/// The state of a document, which its tables share.
struct TomlState {
  std::string name;
  TomlNode root;
  std::map<std::string, std::string, std::less<>> variables;
  mutable std::vector<std::string> warnings;               ///< in the order in which they came up
  mutable std::vector<std::filesystem::path> inputs = {};  ///< read for keys, each once
  /// Old and new names of keys at the top of this document alone.
  std::map<std::string, std::string, std::less<>> renamed = {};

  /// The place of a value: `file:line`, or the override that set it.
  std::string location(const TomlNode& node) const;
  /// @throws InvalidInput `location: message`
  [[noreturn]] void fail(const TomlNode& node, std::string_view message) const;
  /// `text` with every `${name}` replaced; `node` is the value with this text.
  std::string substitute(const std::string& text, const TomlNode& node) const;
  /// The value of a variable that is used in `node`.
  std::string variable(const std::string& variable_name, const TomlNode& node) const;
};

/// Parses a text to a tree.
/// @throws InvalidInput `name:line: reason`
TomlNode parse_toml_nodes(std::string_view text, const std::string& name);

/// The value of a TOML expression, or the string `text` if it is not TOML.
TomlNode parse_toml_value(const std::string& text);

/// The kind of a value for messages: "a number", "a string", ...
std::string_view toml_kind_name(TomlKind kind);

/// The description of a value for messages: "is the string \"abc\"", "is an array", ...
std::string describe_toml_value(const TomlNode& node);

/// Sets the value at the dotted path of `key=value`; old names of keys are renamed, with a warning.
/// @throws InvalidInput `--set key=value: reason`
void apply_toml_override(TomlState& state, std::string_view assignment);

/// The parts of the key in `key=value`, without the quotes that they may have.
/// @throws InvalidInput as apply_toml_override where there is no key
std::vector<std::string> override_path(std::string_view assignment);

/// The dotted path `parent.key`, or `key` at the top.
std::string join_toml_path(std::string_view parent, std::string_view key);

/// The name among `names` that differs from `key` only in its unit suffix, or an empty string.
std::string_view same_name_other_unit(std::string_view key,
                                      const std::vector<std::string_view>& names);

/// A key with its unit for messages, such as "'sd_deg' (degrees)".
std::string describe_with_unit(std::string_view key);

/// The name among `names` with the least edit distance to `key`, if that is at most two and less
/// than half of the key's length; otherwise an empty string.
std::string_view nearest_name(std::string_view key, const std::vector<std::string_view>& names);

/// @throws InvalidInput for the first key of `table`, and of every table below it, that no getter
/// was called for
void require_all_known(const TomlState& state, const TomlNode& table, const std::string& path);

}  // namespace posemix::internal
