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

/// Where text and pattern part, the last star takes one character more; those before it need not be
/// tried again.
bool matches_pattern(std::string_view text, std::string_view pattern) {
  std::size_t star = std::string_view::npos;
  std::size_t star_ends = 0;
  std::size_t p = 0;
  for (std::size_t t = 0; t < text.size();) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_ends = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++star_ends;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

}  // namespace posemix
