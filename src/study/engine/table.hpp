// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace posemix {

/// Version of study.json that this library writes (key `schema`).
inline constexpr int kStudySchema = 1;

/// A value of a table; std::monostate if there is none (null in JSON, nothing in CSV).
using Cell = std::variant<std::monostate, double, std::int64_t, std::string>;

/// Rows of named values.
class StudyTable {
 public:
  explicit StudyTable(std::vector<std::string> columns);

  /// @throws InvalidInput unless there is one cell per column
  void add(std::vector<Cell> row);

  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<std::vector<Cell>>& rows() const { return rows_; }

  /// Comma-separated values with a head line; numbers with as many digits as are needed to
  /// read them back exactly, texts quoted if necessary.
  std::string csv() const;
  /// Aligned columns; numbers with `digits` significant digits.
  std::string text(int digits = 5) const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<Cell>> rows_;
};

/// What study.json says beside its numbers.
struct StudyText {
  std::string_view study;               ///< its name
  std::string_view description;         ///< what it asks, in one sentence
  std::vector<std::string> notes = {};  ///< what the numbers say, in sentences
};

/// The file study.json: {"schema": 1, "study": name, "description": ..., "notes": [...], "columns":
/// {...}, "rows": [{column: value, ...}, ...]}. A number that is not finite is written as null.
std::string format_study(const StudyText& text, const StudyTable& rows);

/// The same with a second table under the key "summary".
std::string format_study(const StudyText& text, const StudyTable& rows, const StudyTable& summary);

}  // namespace posemix
