// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "paths.hpp"

#include <algorithm>

#include "posemix/io/text.hpp"

namespace posemix {

bool is_inner_path(std::string_view path) {
  const auto forbidden = [](char c) {
    return c == '\\' || c == '\x7f' || static_cast<unsigned char>(c) < ' ';
  };
  if (path.empty() || std::any_of(path.begin(), path.end(), forbidden)) return false;
  const auto parts = split_fields(path, '/');
  return std::none_of(parts.begin(), parts.end(), [](std::string_view part) {
    return part.empty() || part == "." || part == "..";
  });
}

bool matches_pattern(std::string_view text, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return text == pattern;
  if (text.size() < star || text.substr(0, star) != pattern.substr(0, star)) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t begin = star; begin <= text.size(); ++begin) {
    if (matches_pattern(text.substr(begin), rest)) return true;
  }
  return false;
}

}  // namespace posemix
