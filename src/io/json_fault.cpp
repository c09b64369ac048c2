// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "json_fault.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

/// What stands between two marks, the first of which comes first in the text; empty where there is
/// none.
std::string_view between(std::string_view text, std::string_view from, std::string_view to) {
  const std::size_t start = text.find(from);
  if (start == std::string_view::npos) return {};
  const std::string_view rest = text.substr(start + from.size());
  return rest.substr(0, rest.find(to));
}

/// A token of JSON, which the parser calls a literal.
std::string token_words(std::string_view token) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kWords{{
      {"number literal", "a number"},
      {"string literal", "a string"},
      {"true literal", "true"},
      {"false literal", "false"},
      {"null literal", "null"},
      {"end of input", "the end of the text"},
      {"'[', '{', or a literal", "a value"},
  }};
  for (const auto& [word, plain] : kWords) {
    if (token == word) return std::string(plain);
  }
  return std::string(token);
}

/// The byte at which a text that was read ends; the parser writes control characters as <U+001F>.
std::string last_byte(std::string_view read) {
  const std::size_t code = read.rfind("<U+");
  if (code != std::string_view::npos && read.ends_with('>')) {
    return "the character " + std::string(read.substr(code + 1, read.size() - code - 2));
  }
  return in_quotes(read.substr(read.empty() ? 0 : read.size() - 1));
}

/// The kind of a wrong word, string, number or comment.
std::string invalid_words(std::string_view what, std::string_view read) {
  if (what == "literal") return fmt::format("got {}, expected a value or a key", last_byte(read));
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kWords{{
      {"string: missing closing quote", "a string without a closing quote"},
      {"string: control character", "a control character in a string, expected an escape"},
      {"string: ill-formed UTF-8", "a string that is not UTF-8"},
      {"string", "a string with a wrong escape"},
      {"number", "a number that does not end as one"},
      {"comment", "a comment that does not end"},
  }};
  for (const auto& [word, plain] : kWords) {
    if (what.starts_with(word)) return std::string(plain);
  }
  return "it cannot be read";
}

/// The parser says "... - invalid WHAT; last read: 'TEXT'; expected TOKEN" or
/// "... - unexpected TOKEN; expected TOKEN".
std::string reason_of(std::string_view message) {
  constexpr std::string_view kInvalid = " - invalid ";
  constexpr std::string_view kUnexpected = " - unexpected ";
  const std::string_view number = between(message, "number overflow parsing '", "'");
  if (!number.empty()) return fmt::format("the number {} is too large", number);
  if (const std::string_view invalid = between(message, kInvalid, "; "); !invalid.empty()) {
    std::string_view read = between(message, "last read: '", "'; expected ");
    const bool is_last = message.ends_with('\'') && !read.empty();
    if (is_last) read.remove_suffix(1);
    return invalid_words(invalid, read);
  }
  const std::string_view token = between(message, kUnexpected, "; expected ");
  if (token == "end of input") return "the text ends too early";
  if (token.empty()) return "it cannot be read";
  const std::size_t expected = message.rfind("; expected ");
  std::string what = "got " + token_words(token);
  if (expected == std::string_view::npos) return what;
  return fmt::format("{}, expected {}", what, token_words(message.substr(expected + 11)));
}

}  // namespace

std::string json_fault(const Json::exception& error) {
  const std::string_view message = error.what();
  const std::string_view place = between(message, "parse error at ", ": ");
  if (place.empty()) return reason_of(message);
  return fmt::format("{}: {}", place, reason_of(message));
}

void refuse_json(const Json::exception& error, const std::string& name, std::string_view expected) {
  throw InvalidInput(fmt::format("{}: got a text that is not JSON ({}), expected {}", name,
                                 json_fault(error), expected));
}

void check_json_depth(int depth, const std::string& name) {
  constexpr int kDeepest = 100;
  if (depth <= kDeepest) return;
  throw InvalidInput(fmt::format(
      "{}: got a value within more than {} arrays and objects, expected fewer", name, kDeepest));
}

Json json_of(std::string_view text, const std::string& name, std::string_view expected) {
  const auto check = [&](int depth, Json::parse_event_t, const Json&) {
    check_json_depth(depth, name);
    return true;
  };
  try {
    return Json::parse(text, check);
  } catch (const Json::exception& error) {
    refuse_json(error, name, expected);
  }
}

}  // namespace posemix::internal
