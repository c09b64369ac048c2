// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/io/rigid.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {

/// The rows of a table whose first line names the columns; blank lines and lines that start with
/// '#' are skipped. Every member throws InvalidInput `name:line: got ..., expected ...`.
class CsvTable {
 public:
  CsvTable(std::string_view text, const std::string& name);

  /// Moves to the next row, which has as many fields as there are columns; false at the end.
  bool next();

  bool has(const std::string& column) const { return columns_.count(column) != 0; }
  /// Throws unless the table has the column.
  void require_column(const std::string& column) const;
  /// Throws unless the table has all columns of a pose: `prefix` followed by tx, ty, tz, qx, qy,
  /// qz, qw.
  void require_pose(const std::string& prefix) const;

  /// The indices of the columns by name, sorted by name.
  const std::map<std::string, std::size_t>& columns() const { return columns_; }
  std::string_view field(const std::string& column) const;
  double number(const std::string& column) const;
  std::int64_t index(const std::string& column) const;
  SE3d pose(const std::string& prefix) const;

  const LineReader& reader() const { return reader_; }

 private:
  LineReader reader_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::string_view> fields_;
};

}  // namespace posemix::internal
