// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "columns.hpp"
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

/// The cells of a row as texts; `format_double` formats floating-point numbers. What is no number
/// has no sign.
template <class FormatDouble>
std::vector<std::string> cell_texts(const std::vector<Cell>& row,
                                    const FormatDouble& format_double) {
  std::vector<std::string> texts(row.size());
  std::transform(row.begin(), row.end(), texts.begin(), [&](const Cell& cell) -> std::string {
    if (const auto* number = std::get_if<double>(&cell))
      return std::isnan(*number) ? "nan" : format_double(*number);
    if (const auto* integer = std::get_if<std::int64_t>(&cell)) return fmt::format("{}", *integer);
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return {};
  });
  return texts;
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

nlohmann::ordered_json rows_json(const StudyTable& table) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& row : table.rows()) {
    nlohmann::ordered_json& object = rows.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) object[table.columns()[i]] = cell_json(row[i]);
  }
  return rows;
}

nlohmann::ordered_json document_of(const StudyText& text, const std::vector<std::string>& columns,
                                   const StudyTable& rows) {
  nlohmann::ordered_json document;
  document["schema"] = kStudySchema;
  document["study"] = text.study;
  document["description"] = text.description;
  document["notes"] = text.notes;
  document["columns"] = columns_json(columns);
  document["rows"] = rows_json(rows);
  return document;
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
  const auto line = [](std::vector<std::string> cells) {
    std::transform(cells.begin(), cells.end(), cells.begin(), quoted);
    return fmt::format("{}\n", fmt::join(cells, ","));
  };
  std::string result = line(columns_);
  for (const auto& row : rows_) {
    result += line(cell_texts(row, [](double number) { return fmt::format("{}", number); }));
  }
  return result;
}

std::string StudyTable::text(int digits) const {
  std::vector<std::vector<std::string>> lines(1 + rows_.size());
  lines[0] = columns_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    lines[i + 1] = cell_texts(
        rows_[i], [digits](double number) { return fmt::format("{:.{}g}", number, digits); });
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

std::string format_study(const StudyText& text, const StudyTable& rows) {
  return document_of(text, rows.columns(), rows).dump(1) + "\n";
}

std::string format_study(const StudyText& text, const StudyTable& rows, const StudyTable& summary) {
  std::vector<std::string> columns = rows.columns();
  for (const std::string& name : summary.columns()) {
    if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  }
  nlohmann::ordered_json document = document_of(text, columns, rows);
  document["summary"] = rows_json(summary);
  return document.dump(1) + "\n";
}

}  // namespace posemix
