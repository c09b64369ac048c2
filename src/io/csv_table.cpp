// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "csv_table.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

constexpr std::array<const char*, 7> kPoseColumns{"tx", "ty", "tz", "qx", "qy", "qz", "qw"};

}  // namespace

CsvTable::CsvTable(std::string_view text, const std::string& name) : reader_(text, name) {
  if (!reader_.next_content()) {
    throw InvalidInput(fmt::format("{}: got no line, expected the names of the columns", name));
  }
  for (const std::string_view column : split_fields(reader_.line(), ',')) {
    const std::string word(trimmed(column));
    if (!columns_.emplace(word, columns_.size()).second) {
      reader_.fail(fmt::format("column {} again", in_quotes(word)), "every column once");
    }
  }
}

bool CsvTable::next() {
  if (!reader_.next_content()) return false;
  fields_ = split_fields(reader_.line(), ',');
  if (fields_.size() == columns_.size()) return true;
  reader_.fail(fmt::format("{} columns", fields_.size()), fmt::format("{}", columns_.size()));
}

void CsvTable::require_column(const std::string& column) const {
  if (!has(column)) reader_.fail("no column " + column, "one of that name");
}

void CsvTable::require_pose(const std::string& prefix) const {
  for (const char* column : kPoseColumns) require_column(prefix + column);
}

std::string_view CsvTable::field(const std::string& column) const {
  return trimmed(fields_[columns_.at(column)]);
}

double CsvTable::number(const std::string& column) const {
  return reader_.number_from(field(column), column);
}

std::int64_t CsvTable::index(const std::string& column) const {
  return reader_.index_from(field(column), column);
}

SE3d CsvTable::pose(const std::string& prefix) const {
  PoseNumbers numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = number(prefix + kPoseColumns[i]);
  const double norm =
      Eigen::Map<const Eigen::Vector4d>(numbers.data() + 3).stableNorm();  // qx qy qz qw
  if (!(std::abs(norm - 1.0) <= kQuaternionNormTolerance)) {
    reader_.fail(fmt::format("a quaternion of norm {:.6g} in {}qx ... {}qw", norm, prefix, prefix),
                 fmt::format("norm 1 within {:g}", kQuaternionNormTolerance));
  }
  return pose_from_numbers(numbers, reader_);
}

}  // namespace posemix::internal
