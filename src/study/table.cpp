// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/study/table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

/// One cell as text, by the formatter of floating-point numbers.
template <class FormatDouble>
std::string cell_text(const Cell& cell, const FormatDouble& format_double) {
  if (const auto* number = std::get_if<double>(&cell)) return format_double(*number);
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return fmt::format("{}", *integer);
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return {};
}

nlohmann::ordered_json cell_json(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) {
    if (std::isfinite(*number)) return *number;
    return nullptr;
  }
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return *integer;
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

}  // namespace

StudyTable::StudyTable(std::vector<std::string> columns) : columns_(std::move(columns)) {}

void StudyTable::add(std::vector<Cell> row) {
  if (row.size() != columns_.size()) {
    throw InvalidInput(
        fmt::format("a row of {} cells for {} columns", row.size(), columns_.size()));
  }
  rows_.push_back(std::move(row));
}

std::string StudyTable::csv() const {
  const auto line = [](const std::vector<std::string>& cells) {
    std::vector<std::string> parts;
    for (const std::string& cell : cells) parts.push_back(quoted(cell));
    return fmt::format("{}\n", fmt::join(parts, ","));
  };
  std::string result = line(columns_);
  for (const auto& row : rows_) {
    std::vector<std::string> cells;
    for (const Cell& cell : row) {
      cells.push_back(cell_text(cell, [](double number) { return fmt::format("{}", number); }));
    }
    result += line(cells);
  }
  return result;
}

std::string StudyTable::text(int digits) const {
  std::vector<std::vector<std::string>> lines{columns_};
  for (const auto& row : rows_) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const Cell& cell : row) {
      line.push_back(
          cell_text(cell, [&](double number) { return fmt::format("{:.{}g}", number, digits); }));
    }
  }
  std::string result;
  for (const auto& line : lines) {
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      std::size_t width = 0;
      for (const auto& other : lines) width = std::max(width, other[column].size());
      const bool is_text =
          !rows_.empty() && std::holds_alternative<std::string>(rows_.front()[column]);
      const std::string gap = column == 0 ? "" : "  ";
      result += is_text ? fmt::format("{}{:<{}}", gap, line[column], width)
                        : fmt::format("{}{:>{}}", gap, line[column], width);
    }
    result.erase(result.find_last_not_of(' ') + 1);
    result += '\n';
  }
  return result;
}

std::string format_study(std::string_view study, const StudyTable& rows) {
  nlohmann::ordered_json document;
  document["schema"] = kStudySchema;
  document["study"] = study;
  document["rows"] = nlohmann::ordered_json::array();
  for (const auto& row : rows.rows()) {
    nlohmann::ordered_json& object = document["rows"].emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) object[rows.columns()[i]] = cell_json(row[i]);
  }
  return document.dump(1) + "\n";
}

}  // namespace posemix
