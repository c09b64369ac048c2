// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "posemix/base/range.hpp"
#include "posemix/base/words.hpp"

/// Checked reading of TOML: every error names file, line and key, and every key must be read.
namespace posemix {

namespace internal {
struct TomlNode;
struct TomlState;
}  // namespace internal

/// A table of a TomlDocument, for reading its values. Cheap to copy; keeps the document's values
/// alive, but is invalid after TomlDocument::apply_override.
///
/// Every getter throws InvalidInput `file:line: key 'noise.mug.weight' is a string, expected a
/// number in [0, 1]` when the value is of a wrong type or out of range, or is missing and the
/// getter has no default. For a value from an override the message has `--set key=value` in place
/// of `file:line`. If a key is missing but exists with another unit suffix, the message says so
/// (`key 'sd_rad': expected 'sd_deg' (degrees)`).
///
/// A key that a getter (or has()) was called for counts as known. Call finish() when all are read.
class TomlTable {
 public:
  /// The dotted path of this table, such as `noise.mug` or `objects[0]`; empty for the top of the
  /// document.
  const std::string& path() const { return path_; }
  /// The keys of the table in the order of the text. This call does not make them known.
  std::vector<std::string> keys() const;
  /// Whether the key exists.
  bool has(std::string_view key) const;
  /// Whether the key exists and its value is an array.
  bool is_array(std::string_view key) const;
  bool is_string(std::string_view key) const;
  /// Whether the key exists and its value is a table.
  bool is_table(std::string_view key) const;

  /// A finite number; integers are accepted too.
  double get_double(std::string_view key, const NumberRange& range = kAnyNumber) const;
  double get_double_or(std::string_view key, double otherwise,
                       const NumberRange& range = kAnyNumber) const;

  std::int64_t get_integer(std::string_view key, const IntegerRange& range = kAnyInteger) const;
  std::int64_t get_integer_or(std::string_view key, std::int64_t otherwise,
                              const IntegerRange& range = kAnyInteger) const;

  bool get_bool(std::string_view key) const;
  bool get_bool_or(std::string_view key, bool otherwise) const;

  /// A string in which `${name}` is replaced (see TomlDocument). A number or boolean from an
  /// override is taken as the text that was written there.
  std::string get_string(std::string_view key) const;
  std::string get_string_or(std::string_view key, std::string_view otherwise) const;

  /// One of the allowed words; the result is its index among them.
  std::size_t get_word(std::string_view key, std::span<const std::string_view> words) const;

  /// The value for a word: `get_enum<Rule>("rule", {{"midway", Rule::midway}, ...})`.
  template <typename Value>
  Value get_enum(std::string_view key,
                 std::initializer_list<std::pair<std::string_view, Value>> choices) const;
  template <typename Value>
  Value get_enum_or(std::string_view key, Value otherwise,
                    std::initializer_list<std::pair<std::string_view, Value>> choices) const;

  /// The value for a word of the table `words<Value>` of an enum.
  template <Spelled Value>
  Value get_enum(std::string_view key) const;
  template <Spelled Value>
  Value get_enum_or(std::string_view key, Value otherwise) const;

  /// An array of `size` finite numbers (of any size if not given), each within the range.
  Eigen::VectorXd get_vector(std::string_view key, std::optional<Eigen::Index> size = {},
                             const NumberRange& range = kAnyNumber) const;
  Eigen::VectorXd get_vector_or(std::string_view key, const Eigen::VectorXd& otherwise,
                                const NumberRange& range = kAnyNumber) const;

  /// An array of rows, each an array of finite numbers.
  Eigen::MatrixXd get_matrix(std::string_view key, Eigen::Index rows, Eigen::Index columns) const;

  /// An array of strings, each treated as by get_string.
  std::vector<std::string> get_strings(std::string_view key) const;
  std::vector<std::string> get_strings_or(std::string_view key,
                                          const std::vector<std::string>& otherwise) const;

  /// Any value but a date in the form of TOML on one line, with `${name}` in strings replaced.
  std::string text_of(std::string_view key) const;

  TomlTable get_table(std::string_view key) const;
  std::optional<TomlTable> find_table(std::string_view key) const;

  /// An array of tables, `[[key]]`; at least one.
  std::vector<TomlTable> get_tables(std::string_view key) const;
  /// An array of tables; empty if the key is missing.
  std::vector<TomlTable> find_tables(std::string_view key) const;

  /// The place where the key's value (or, without one, this table) was written: `file:line` or
  /// `--set key=value`.
  std::string location(std::string_view key) const;
  /// @throws InvalidInput `location: key 'path.key' message`
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;
  /// Adds `location: key 'path.key' message` to the warnings of the document.
  void warn(std::string_view key, std::string_view message) const;
  /// Notes that a file, or a folder, was read for a key (TomlDocument::inputs).
  void note_input(const std::filesystem::path& path) const;
  /// Keys of earlier releases that have no effect any more: a warning for each that is there.
  void ignore_removed(std::initializer_list<std::string_view> keys, std::string_view reason) const;

  /// Throws InvalidInput for a key of this table, or of any table below it, that no getter was
  /// called for. The message has its place and a similar known key.
  void finish() const;

 private:
  friend class TomlDocument;
  TomlTable(std::shared_ptr<const internal::TomlState> state, const internal::TomlNode* node,
            std::string path);

  const internal::TomlNode* find(std::string_view key) const;
  const internal::TomlNode& require(std::string_view key, std::string_view expected) const;
  [[noreturn]] void fail_value(std::string_view key, const internal::TomlNode& node,
                               std::string_view expected) const;
  [[noreturn]] void fail_missing(std::string_view key, std::string_view expected) const;
  double number_of(std::string_view key, const internal::TomlNode& node, const NumberRange& range,
                   std::string_view expected) const;
  std::string string_of(std::string_view key, const internal::TomlNode& node,
                        std::string_view expected) const;
  std::vector<TomlTable> tables_of(std::string_view key, const internal::TomlNode& node) const;

  std::shared_ptr<const internal::TomlState> state_;
  const internal::TomlNode* node_;
  std::string path_;
};

/// A TOML document with overrides and variables.
///
/// `${name}` in a string is replaced by the variable `name`: the one of set_variable, otherwise the
/// string or integer under the key `name` at the top of the document (which then counts as known).
/// `${` without `}` and names that are neither are errors.
class TomlDocument {
 public:
  /// Parses a text; `name` is the name of the file in messages. Keys of sequence files under old
  /// names are renamed, with a warning for each.
  /// @throws InvalidInput `name:line: reason`, also for an empty text, a text above 1 MiB, and a
  /// key that occurs under its old and its new name
  static TomlDocument parse(std::string_view text, const std::string& name);
  /// Parses a file.
  static TomlDocument load(const std::filesystem::path& path);

  /// Sets a value by its path: `filter.gate=0.99`, `objects.0.detections=mug.txt`,
  /// `objects.mug.detections=...`.
  ///
  /// If a part of the path refers to an array, it is an index from zero or the `id` of one of its
  /// tables. A part may be quoted ("a.b"). Tables on the path are created. The text after '=' is a
  /// TOML value, or if it is not (a bare word, 0001) a string.
  /// @throws InvalidInput `--set key=value: reason`
  void apply_override(std::string_view assignment);

  /// From now on reads the key `old_name` at the top of this document as `new_name`, with a
  /// warning.
  /// @throws InvalidInput when the document has both
  void rename_key(const std::string& old_name, const std::string& new_name);

  /// Sets the variable `name`, which takes precedence over the document's own.
  void set_variable(const std::string& name, const std::string& value);

  /// The table at the top.
  TomlTable root() const;
  const std::string& name() const;
  /// Warnings so far: about keys that were given under names of an earlier release
  /// (`file:line: key 'noise.mug.null' is now 'noise.mug.clutter'; ...`), and about what a reader
  /// assumed where keys are missing.
  const std::vector<std::string>& warnings() const;
  /// Files and folders that were read for the document's keys so far, each once.
  const std::vector<std::filesystem::path>& inputs() const;

  /// Calls TomlTable::finish for the whole document.
  void finish() const { root().finish(); }

 private:
  explicit TomlDocument(std::shared_ptr<internal::TomlState> state);
  std::shared_ptr<internal::TomlState> state_;
};

template <typename Value>
Value TomlTable::get_enum(std::string_view key,
                          std::initializer_list<std::pair<std::string_view, Value>> choices) const {
  std::vector<std::string_view> words;
  for (const auto& choice : choices) words.push_back(choice.first);
  return (choices.begin() + get_word(key, words))->second;
}

template <Spelled Value>
Value TomlTable::get_enum(std::string_view key) const {
  std::array<std::string_view, words<Value>.size()> allowed;
  for (std::size_t i = 0; i < allowed.size(); ++i) allowed[i] = words<Value>[i].first;
  return words<Value>[get_word(key, allowed)].second;
}

template <Spelled Value>
Value TomlTable::get_enum_or(std::string_view key, Value otherwise) const {
  return has(key) ? get_enum<Value>(key) : otherwise;
}

template <typename Value>
Value TomlTable::get_enum_or(
    std::string_view key, Value otherwise,
    std::initializer_list<std::pair<std::string_view, Value>> choices) const {
  return has(key) ? get_enum(key, choices) : otherwise;
}

}  // namespace posemix
