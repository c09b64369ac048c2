// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "screen_text.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace posemix {
namespace {

using Lines = std::vector<std::string_view>;

/// A heading, the names of the columns, a row, and what is left out.
constexpr std::size_t kFewestLines = 4;

std::vector<Lines> tables_of(std::string_view text) {
  std::vector<Lines> tables(1);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) {
      tables.back().push_back(text.substr(0, end));
    } else if (!tables.back().empty()) {
      tables.emplace_back();
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (tables.back().empty()) tables.pop_back();
  return tables;
}

/// The largest number of lines of one table with which all fit.
std::size_t lines_of_each(const std::vector<Lines>& tables, std::size_t most_lines) {
  const auto all = [&](std::size_t each) {
    std::size_t sum = tables.size() - 1;
    for (const Lines& table : tables) sum += std::min(table.size(), each);
    return sum;
  };
  std::size_t each = kFewestLines;
  while (each < most_lines && all(each + 1) <= most_lines) ++each;
  return each;
}

}  // namespace

std::string screen_text(std::string_view text, std::size_t most_lines) {
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  if (lines <= most_lines) return std::string(text);
  const std::vector<Lines> tables = tables_of(text);
  const std::size_t each = lines_of_each(tables, most_lines);
  std::string shown;
  for (const Lines& table : tables) {
    if (!shown.empty()) shown += '\n';
    const bool is_whole = table.size() <= each;
    const std::size_t kept = is_whole ? table.size() : each - 1;
    for (std::size_t i = 0; i < kept; ++i) shown += fmt::format("{}\n", table[i]);
    if (!is_whole) shown += fmt::format("... {} rows more\n", table.size() - kept);
  }
  return shown;
}

}  // namespace posemix
