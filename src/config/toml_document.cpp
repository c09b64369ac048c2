// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/io/text.hpp"
#include "toml_node.hpp"
#include "toml_renamed.hpp"

namespace posemix::internal {

const TomlNode* TomlNode::find(std::string_view key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &children[static_cast<std::size_t>(found - keys.begin())];
}

TomlNode* TomlNode::find(std::string_view key) {
  return const_cast<TomlNode*>(std::as_const(*this).find(key));
}

std::string TomlState::location(const TomlNode& node) const {
  return node.origin.empty() ? fmt::format("{}:{}", name, node.line) : node.origin;
}

void TomlState::fail(const TomlNode& node, std::string_view message) const {
  throw InvalidInput(fmt::format("{}: {}", location(node), message));
}

std::string TomlState::substitute(const std::string& text, const TomlNode& node) const {
  std::string result;
  std::size_t begin = 0;
  for (std::size_t open; (open = text.find("${", begin)) != std::string::npos;) {
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) {
      fail(node, fmt::format("got '${{' without '}}' in {}", in_quotes(text, 80)));
    }
    result += text.substr(begin, open - begin);
    result += variable(text.substr(open + 2, close - open - 2), node);
    begin = close + 1;
  }
  return result + text.substr(begin);
}

std::string TomlState::variable(const std::string& variable_name, const TomlNode& node) const {
  root.known.insert(variable_name);
  if (const auto given = variables.find(variable_name); given != variables.end())
    return given->second;
  const TomlNode* value = root.find(variable_name);
  if (value == nullptr) {
    const std::vector<std::string_view> names(root.keys.begin(), root.keys.end());
    const std::string_view near = nearest_name(variable_name, names);
    const std::string hint = near.empty() ? "" : fmt::format(", or did you mean ${{{}}}?", near);
    fail(node, fmt::format("got ${{{0}}}, but there is no key '{0}' at the top of the document: "
                           "give it there or by --set {0}=...{1}",
                           variable_name, hint));
  }
  if (!value->raw.empty() && value->kind != TomlKind::string) return value->raw;
  if (value->kind == TomlKind::integer) return fmt::format("{}", value->integer);
  if (value->kind != TomlKind::string || value->string.find("${") != std::string::npos) {
    fail(*value, fmt::format("key '{}' {}, expected a plain string, since it is used as ${{{}}}",
                             variable_name, describe_toml_value(*value), variable_name));
  }
  return value->string;
}

std::string_view toml_kind_name(TomlKind kind) {
  switch (kind) {
    case TomlKind::boolean:
      return "a boolean";
    case TomlKind::integer:
      return "an integer";
    case TomlKind::number:
      return "a number";
    case TomlKind::string:
      return "a string";
    case TomlKind::date:
      return "a date or time";
    case TomlKind::array:
      return "an array";
    case TomlKind::table:
      return "a table";
  }
  return "a value";
}

std::string describe_toml_value(const TomlNode& node) {
  switch (node.kind) {
    case TomlKind::integer:
      return fmt::format("is {}", node.integer);
    case TomlKind::number:
      return fmt::format("is {}", node.number);
    case TomlKind::string:
      return fmt::format("is the string {}", in_quotes(node.string));
    default:
      return fmt::format("is {}", toml_kind_name(node.kind));
  }
}

}  // namespace posemix::internal

namespace posemix {

using namespace internal;

TomlDocument::TomlDocument(std::shared_ptr<TomlState> state) : state_(std::move(state)) {}

TomlDocument TomlDocument::parse(std::string_view text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InvalidInput(fmt::format("{}: got an empty text, expected a TOML document", name));
  }
  auto state = std::make_shared<TomlState>();
  state->name = name;
  state->root = parse_toml_nodes(text, name);
  rename_old_keys(*state);
  return TomlDocument(std::move(state));
}

TomlDocument TomlDocument::load(const std::filesystem::path& path) {
  return parse(read_file(path), path.string());
}

void TomlDocument::apply_override(std::string_view assignment) {
  apply_toml_override(*state_, assignment);
}

void TomlDocument::rename_key(const std::string& old_name, const std::string& new_name) {
  state_->renamed[old_name] = new_name;
  internal::rename_old_keys(*state_);
}

void TomlDocument::set_variable(const std::string& name, const std::string& value) {
  state_->variables[name] = value;
}

TomlTable TomlDocument::root() const { return TomlTable(state_, &state_->root, ""); }

const std::string& TomlDocument::name() const { return state_->name; }

const std::vector<std::filesystem::path>& TomlDocument::inputs() const { return state_->inputs; }

const std::vector<std::string>& TomlDocument::warnings() const { return state_->warnings; }

}  // namespace posemix
