// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "study/engine/table.hpp"

namespace posemix {

/// A study's table, read by names.
class TableReader {
 public:
  static constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

  explicit TableReader(const StudyTable& table) : table_(table) {}

  std::size_t size() const { return table_.rows().size(); }
  std::string text(std::size_t row, std::string_view column) const {
    const auto* text = std::get_if<std::string>(&cell(row, column));
    return text != nullptr ? *text : std::string();
  }
  /// The number in a cell; NaN if there is none.
  double number(std::size_t row, std::string_view column) const {
    const Cell& value = cell(row, column);
    if (const auto* integer = std::get_if<std::int64_t>(&value))
      return static_cast<double>(*integer);
    const auto* number = std::get_if<double>(&value);
    return number != nullptr ? *number : kNothing;
  }
  /// Names the recording and object of a row.
  std::string key(std::size_t row) const {
    return text(row, "detector") + "/" + text(row, "sequence") + "/" + text(row, "object");
  }
  /// The different texts of a column, in the order of first appearance.
  std::vector<std::string> names(std::string_view column) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < size(); ++i) {
      const std::string name = text(i, column);
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names;
  }

 private:
  const Cell& cell(std::size_t row, std::string_view column) const {
    const auto& columns = table_.columns();
    const auto found = std::find(columns.begin(), columns.end(), column);
    return table_.rows()[row][static_cast<std::size_t>(found - columns.begin())];
  }

  const StudyTable& table_;
};

}  // namespace posemix
