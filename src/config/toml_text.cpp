// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <fmt/format.h>

#include "posemix/config/toml_table.hpp"
#include "toml_node.hpp"

namespace posemix {
namespace {

using namespace internal;

std::string string_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (code < 0x20 || code == 0x7f) {
      result += fmt::format("\\u{:04X}", code);
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// A number with all of its digits. TOML has inf and nan as words of its own.
std::string number_text(double number) {
  if (std::isnan(number)) return "nan";
  if (std::isinf(number)) return number > 0.0 ? "inf" : "-inf";
  return fmt::format("{}", number);
}

std::string text_of_node(const TomlState& state, const TomlNode& node) {
  std::string text;
  switch (node.kind) {
    case TomlKind::boolean:
      return node.boolean ? "true" : "false";
    case TomlKind::integer:
      return fmt::format("{}", node.integer);
    case TomlKind::number:
      return number_text(node.number);
    case TomlKind::string:
      return string_text(state.substitute(node.string, node));
    case TomlKind::array:
      for (const TomlNode& item : node.children)
        text += (text.empty() ? "" : ", ") + text_of_node(state, item);
      return "[" + text + "]";
    case TomlKind::table:
      for (std::size_t i = 0; i < node.children.size(); ++i) {
        text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", string_text(node.keys[i]),
                            text_of_node(state, node.children[i]));
      }
      return "{" + text + "}";
    case TomlKind::date:
      break;
  }
  state.fail(node, "got a date, expected another value");
}

}  // namespace

std::string TomlTable::text_of(std::string_view key) const {
  return text_of_node(*state_, require(key, "a value"));
}

}  // namespace posemix
