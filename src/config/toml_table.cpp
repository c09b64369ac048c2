// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/config/toml_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"
#include "toml_node.hpp"

namespace posemix {
namespace {

using namespace internal;

bool is_array_of_tables(const TomlNode& node) {
  return node.kind == TomlKind::array && !node.children.empty() &&
         std::all_of(node.children.begin(), node.children.end(),
                     [](const TomlNode& item) { return item.kind == TomlKind::table; });
}

std::string indexed(std::string_view key, std::size_t index) {
  return fmt::format("{}[{}]", key, index);
}

/// Counts every key within a value as known.
void know_all(const TomlNode& node) {
  node.known.insert(node.keys.begin(), node.keys.end());
  for (const TomlNode& child : node.children) know_all(child);
}

std::string counted(Eigen::Index count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

TomlTable::TomlTable(std::shared_ptr<const TomlState> state, const TomlNode* node, std::string path)
    : state_(std::move(state)), node_(node), path_(std::move(path)) {}

std::vector<std::string> TomlTable::keys() const { return node_->keys; }

const TomlNode* TomlTable::find(std::string_view key) const {
  node_->known.emplace(key);
  return node_->find(key);
}

bool TomlTable::has(std::string_view key) const { return find(key) != nullptr; }

bool TomlTable::is_array(std::string_view key) const {
  const TomlNode* node = find(key);
  return node != nullptr && node->kind == TomlKind::array;
}

bool TomlTable::is_string(std::string_view key) const {
  const TomlNode* node = find(key);
  return node != nullptr && node->kind == TomlKind::string;
}

bool TomlTable::is_table(std::string_view key) const {
  const TomlNode* node = find(key);
  return node != nullptr && node->kind == TomlKind::table;
}

const TomlNode& TomlTable::require(std::string_view key, std::string_view expected) const {
  const TomlNode* node = find(key);
  if (node == nullptr) fail_missing(key, expected);
  return *node;
}

void TomlTable::fail_missing(std::string_view key, std::string_view expected) const {
  std::vector<std::string_view> unasked;
  for (const std::string& present : node_->keys) {
    if (!node_->known.contains(present)) unasked.push_back(present);
  }
  const std::string full = join_toml_path(path_, key);
  if (const auto other = same_name_other_unit(key, unasked); !other.empty()) {
    state_->fail(*node_->find(other),
                 fmt::format("key '{}': expected {}", join_toml_path(path_, other),
                             describe_with_unit(key)));
  }
  const std::string_view near = nearest_name(key, unasked);
  const std::string hint = near.empty() ? "" : fmt::format(" (there is a key '{}')", near);
  state_->fail(near.empty() ? *node_ : *node_->find(near),
               fmt::format("key '{}' is missing, expected {}{}", full, expected, hint));
}

void TomlTable::fail_value(std::string_view key, const TomlNode& node,
                           std::string_view expected) const {
  state_->fail(node, fmt::format("key '{}' {}, expected {}", join_toml_path(path_, key),
                                 describe_toml_value(node), expected));
}

std::string TomlTable::location(std::string_view key) const {
  const TomlNode* node = node_->find(key);
  return state_->location(node == nullptr ? *node_ : *node);
}

void TomlTable::fail(std::string_view key, std::string_view message) const {
  throw InvalidInput(
      fmt::format("{}: key '{}' {}", location(key), join_toml_path(path_, key), message));
}

void TomlTable::note_input(const std::filesystem::path& path) const {
  std::vector<std::filesystem::path>& inputs = state_->inputs;
  if (std::find(inputs.begin(), inputs.end(), path) == inputs.end()) inputs.push_back(path);
}

void TomlTable::warn(std::string_view key, std::string_view message) const {
  state_->warnings.push_back(
      fmt::format("{}: key '{}' {}", location(key), join_toml_path(path_, key), message));
}

void TomlTable::ignore_removed(std::initializer_list<std::string_view> keys,
                               std::string_view reason) const {
  for (const std::string_view key : keys) {
    const TomlNode* node = find(key);
    if (node == nullptr) continue;
    know_all(*node);
    warn(key, fmt::format("has no effect any more: {}", reason));
  }
}

void TomlTable::finish() const { require_all_known(*state_, *node_, path_); }

double TomlTable::number_of(std::string_view key, const TomlNode& node, const NumberRange& range,
                            std::string_view expected) const {
  const bool numeric = node.kind == TomlKind::integer || node.kind == TomlKind::number;
  const double number =
      node.kind == TomlKind::integer ? static_cast<double>(node.integer) : node.number;
  if (!numeric || !range.contains(number)) fail_value(key, node, expected);
  return number;
}

double TomlTable::get_double(std::string_view key, const NumberRange& range) const {
  const std::string expected = "a " + range.describe();
  return number_of(key, require(key, expected), range, expected);
}

double TomlTable::get_double_or(std::string_view key, double otherwise,
                                const NumberRange& range) const {
  return has(key) ? get_double(key, range) : otherwise;
}

std::int64_t TomlTable::get_integer(std::string_view key, const IntegerRange& range) const {
  const std::string expected = "an " + range.describe();
  const TomlNode& node = require(key, expected);
  const bool inside = node.integer >= range.lowest && node.integer <= range.highest;
  if (node.kind != TomlKind::integer || !inside) fail_value(key, node, expected);
  return node.integer;
}

std::int64_t TomlTable::get_integer_or(std::string_view key, std::int64_t otherwise,
                                       const IntegerRange& range) const {
  return has(key) ? get_integer(key, range) : otherwise;
}

bool TomlTable::get_bool(std::string_view key) const {
  const TomlNode& node = require(key, "true or false");
  if (node.kind != TomlKind::boolean) fail_value(key, node, "true or false");
  return node.boolean;
}

bool TomlTable::get_bool_or(std::string_view key, bool otherwise) const {
  return has(key) ? get_bool(key) : otherwise;
}

std::string TomlTable::string_of(std::string_view key, const TomlNode& node,
                                 std::string_view expected) const {
  if (node.kind == TomlKind::string) return state_->substitute(node.string, node);
  const bool scalar = node.kind != TomlKind::array && node.kind != TomlKind::table;
  if (!scalar || node.raw.empty()) fail_value(key, node, expected);
  return std::string(trimmed(node.raw));
}

std::string TomlTable::get_string(std::string_view key) const {
  return string_of(key, require(key, "a string"), "a string");
}

std::string TomlTable::get_string_or(std::string_view key, std::string_view otherwise) const {
  return has(key) ? get_string(key) : std::string(otherwise);
}

std::size_t TomlTable::get_word(std::string_view key,
                                std::span<const std::string_view> words) const {
  const std::string expected = fmt::format("one of \"{}\"", fmt::join(words, "\", \""));
  const TomlNode& node = require(key, expected);
  const std::string word = string_of(key, node, expected);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) fail_value(key, node, expected);
  return static_cast<std::size_t>(found - words.begin());
}

Eigen::VectorXd TomlTable::get_vector(std::string_view key, std::optional<Eigen::Index> size,
                                      const NumberRange& range) const {
  const std::string kind = range.describe();
  const std::string expected =
      size ? fmt::format("an array of {}", counted(*size, "number")) : "an array of numbers";
  const TomlNode& node = require(key, expected);
  const auto count = static_cast<Eigen::Index>(node.children.size());
  if (node.kind != TomlKind::array) fail_value(key, node, expected);
  if (size && count != *size) {
    fail(key, fmt::format("has {}, expected {}", counted(count, "element"), expected));
  }
  Eigen::VectorXd vector(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    vector[i] = number_of(indexed(key, at), node.children[at], range, "a " + kind);
  }
  return vector;
}

Eigen::VectorXd TomlTable::get_vector_or(std::string_view key, const Eigen::VectorXd& otherwise,
                                         const NumberRange& range) const {
  return has(key) ? get_vector(key, otherwise.size(), range) : otherwise;
}

Eigen::MatrixXd TomlTable::get_matrix(std::string_view key, Eigen::Index rows,
                                      Eigen::Index columns) const {
  const std::string expected =
      fmt::format("an array of {} of {}", counted(rows, "row"), counted(columns, "number"));
  const TomlNode& node = require(key, expected);
  const bool right_rows =
      node.kind == TomlKind::array && node.children.size() == static_cast<std::size_t>(rows);
  if (!right_rows) fail_value(key, node, expected);
  Eigen::MatrixXd matrix(rows, columns);
  for (std::size_t r = 0; r < node.children.size(); ++r) {
    const TomlNode& row = node.children[r];
    const bool right_columns =
        row.kind == TomlKind::array && row.children.size() == static_cast<std::size_t>(columns);
    if (!right_columns)
      fail_value(indexed(key, r), row, "an array of " + counted(columns, "number"));
    for (std::size_t c = 0; c < row.children.size(); ++c) {
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
          number_of(indexed(indexed(key, r), c), row.children[c], kAnyNumber, "a finite number");
    }
  }
  return matrix;
}

std::vector<std::string> TomlTable::get_strings(std::string_view key) const {
  const TomlNode& node = require(key, "an array of strings");
  if (node.kind != TomlKind::array) fail_value(key, node, "an array of strings");
  std::vector<std::string> strings;
  strings.reserve(node.children.size());
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    strings.push_back(string_of(indexed(key, i), node.children[i], "a string"));
  }
  return strings;
}

std::vector<std::string> TomlTable::get_strings_or(
    std::string_view key, const std::vector<std::string>& otherwise) const {
  return has(key) ? get_strings(key) : otherwise;
}

TomlTable TomlTable::get_table(std::string_view key) const {
  const TomlNode& node = require(key, "a table");
  if (node.kind != TomlKind::table) fail_value(key, node, "a table");
  return TomlTable(state_, &node, join_toml_path(path_, key));
}

std::optional<TomlTable> TomlTable::find_table(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  return get_table(key);
}

std::vector<TomlTable> TomlTable::tables_of(std::string_view key, const TomlNode& node) const {
  if (!is_array_of_tables(node)) fail_value(key, node, "an array of tables");
  std::vector<TomlTable> tables;
  tables.reserve(node.children.size());
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    tables.push_back(TomlTable(state_, &node.children[i], indexed(join_toml_path(path_, key), i)));
  }
  return tables;
}

std::vector<TomlTable> TomlTable::get_tables(std::string_view key) const {
  return tables_of(key, require(key, "an array of tables"));
}

std::vector<TomlTable> TomlTable::find_tables(std::string_view key) const {
  const TomlNode* node = find(key);
  return node == nullptr ? std::vector<TomlTable>() : tables_of(key, *node);
}

}  // namespace posemix
