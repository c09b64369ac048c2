// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "covariance_columns.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/io/placeholder_covariance.hpp"
#include "posemix/io/rigid.hpp"

namespace posemix::internal {

const std::vector<std::string>& covariance_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> names;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) names.push_back(fmt::format("c{}{}", i, j));
    }
    return names;
  }();
  return columns;
}

std::string pose_header() { return fmt::format("{}", fmt::join(kPoseFields, ",")); }

std::string covariance_header() { return fmt::format("{}", fmt::join(covariance_columns(), ",")); }

std::string pose_fields(const SE3d& pose) {
  std::string fields = format_pose(pose);
  std::replace(fields.begin(), fields.end(), ' ', ',');
  return fields;
}

std::string covariance_fields(const std::optional<Matrix6d>& covariance) {
  std::string fields;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) {
      if (i + j > 0) fields += ',';
      if (covariance) fields += fmt::format("{:.12g}", (*covariance)(i, j) + 0.0);
    }
  }
  return fields;
}

SE3d pose_in(const CsvTable& table) {
  PoseNumbers numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = table.number(kPoseFields[i]);
  return pose_from_numbers(numbers, table.reader());
}

std::optional<Matrix6d> covariance_in(const CsvTable& table) {
  const std::vector<std::string>& columns = covariance_columns();
  if (!table.has(columns.front())) return std::nullopt;
  const auto is_empty = [&](const std::string& column) { return table.field(column).empty(); };
  const auto empty = std::count_if(columns.begin(), columns.end(), is_empty);
  if (empty == static_cast<std::ptrdiff_t>(columns.size())) return std::nullopt;
  if (empty > 0)
    table.reader().fail(fmt::format("{} empty fields of a covariance", empty), "none or all 21");
  Matrix6d covariance;
  std::size_t next = 0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j)
      covariance(i, j) = covariance(j, i) = table.number(columns[next++]);
  }
  if (is_placeholder_covariance(covariance)) return std::nullopt;
  return covariance;
}

}  // namespace posemix::internal
