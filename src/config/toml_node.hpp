// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// The tree of a TOML document, apart from the parsing library.
namespace posemix {

enum class TomlKind { boolean, integer, number, string, date, array, table };

/// One value and where it was written.
struct TomlNode {
  TomlKind kind = TomlKind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0;
  std::string string;
  std::vector<std::string> keys;   ///< of a table, in the order of the text, one for each child
  std::vector<TomlNode> children;  ///< of a table or an array
  std::size_t line = 1;
  std::string origin;  ///< "--set key=value" for an override, empty for a value of the file
  std::string raw;     ///< the override's text after '='
  mutable std::set<std::string, std::less<>> known;  ///< the keys of a table that were asked for

  /// The child under `key`, or null.
  const TomlNode* find(std::string_view key) const;
  TomlNode* find(std::string_view key);
};

/// A document that its tables share.
struct TomlState {
  std::string name;
  TomlNode root;
  std::map<std::string, std::string, std::less<>> variables;
  std::vector<std::string> warnings;  ///< about keys under their old names
  /// Old and new names of keys at the top of this document alone.
  std::map<std::string, std::string, std::less<>> renamed = {};

  /// `file:line` of a value, or the override that it came from.
  std::string location(const TomlNode& node) const;
  /// Throws InvalidInput `location: message`.
  [[noreturn]] void fail(const TomlNode& node, std::string_view message) const;
  /// `text` with every `${name}` replaced. `node` is where the text stands.
  std::string substitute(const std::string& text, const TomlNode& node) const;
  /// The value of a variable that is used at `node`.
  std::string variable(const std::string& variable_name, const TomlNode& node) const;
};

/// The tree of a text; throws InvalidInput `name:line: reason`.
TomlNode parse_toml_nodes(std::string_view text, const std::string& name);

/// The value that `text` writes in TOML, or the string `text` where it is not TOML.
TomlNode parse_toml_value(const std::string& text);

/// "a number", "a string", ... for messages.
std::string_view toml_kind_name(TomlKind kind);

/// "is the string \"abc\"", "is an array", ... for messages.
std::string describe_toml_value(const TomlNode& node);

/// Sets the value at the dotted path of `key=value`; old names of keys are renamed, with a
/// warning. Throws InvalidInput.
void apply_toml_override(TomlState& state, std::string_view assignment);

/// `parent.key`, or `key` at the top.
std::string join_toml_path(std::string_view parent, std::string_view key);

/// The name among `names` that is the same as `key` but for its unit suffix, or an empty string.
std::string_view same_name_other_unit(std::string_view key,
                                      const std::vector<std::string_view>& names);

/// "'sd_deg' (degrees)" for messages.
std::string describe_with_unit(std::string_view key);

/// The name among `names` with the least edit distance to `key`, where that is at most two and less
/// than half of the key; an empty string otherwise.
std::string_view nearest_name(std::string_view key, const std::vector<std::string_view>& names);

/// Throws InvalidInput for the first key of `table`, and of every table below it, that nobody asked
/// for.
void require_all_known(const TomlState& state, const TomlNode& table, const std::string& path);

}  // namespace posemix
