// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "summary.hpp"

#include <cmath>
#include <map>

#include "posemix/base/statistics.hpp"
#include "table_reader.hpp"

/// The summary compares the rows with the published offline results and with the odometry, and
/// counts recoveries from wrong starts.
namespace posemix {
namespace {

constexpr const char* kReference = "published: ACT";

/// A column of one method by recording and object.
using MethodValues = std::map<std::string, double>;

MethodValues values_of(const TableReader& rows, std::string_view method, std::string_view column) {
  MethodValues values;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows.text(i, "method") == method && !std::isnan(rows.number(i, column)))
      values[rows.key(i)] = rows.number(i, column);
  }
  return values;
}

/// The rows of one detector and method.
struct MethodRows {
  std::string detector;
  std::string method;
  std::vector<std::size_t> rows;
};

std::vector<MethodRows> by_method(const TableReader& table) {
  std::vector<MethodRows> groups;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string detector = table.text(i, "detector");
    const std::string method = table.text(i, "method");
    const auto found = std::find_if(groups.begin(), groups.end(), [&](const MethodRows& group) {
      return group.detector == detector && group.method == method;
    });
    if (found == groups.end()) {
      groups.push_back({detector, method, {i}});
    } else {
      found->rows.push_back(i);
    }
  }
  return groups;
}

/// Makes one row of the summary.
class SummaryRow {
 public:
  SummaryRow(const TableReader& table, const MethodRows& group) : table_(table), group_(group) {}

  Cell median_of(std::string_view column) const {
    std::vector<double> numbers;
    for (const std::size_t i : group_.rows) {
      if (!std::isnan(table_.number(i, column))) numbers.push_back(table_.number(i, column));
    }
    return numbers.empty() ? Cell() : Cell(median(numbers));
  }

  /// The number of rows whose column is below the reference; empty if none can be compared.
  Cell better(std::string_view column, const MethodValues& reference) const {
    return count(reference, column, [](double value, double other) { return value < other; });
  }
  /// The number of rows that can be compared with the reference.
  Cell compared(const MethodValues& reference) const {
    return count(reference, "pixel_median", [](double, double) { return true; });
  }

  /// Geometric mean of the ratio of a column to the odometry's value.
  Cell over(const MethodValues& odometry, std::string_view column) const {
    double sum = 0.0;
    std::size_t count = 0;
    for (const std::size_t i : group_.rows) {
      const auto found = odometry.find(table_.key(i));
      const double error = table_.number(i, column);
      if (found == odometry.end() || !(error > 0.0) || !(found->second > 0.0)) continue;
      sum += std::log(error / found->second);
      ++count;
    }
    return count == 0 ? Cell() : Cell(std::exp(sum / static_cast<double>(count)));
  }

  /// The number of rows that end on the right mode although their first detection is wrong, and the
  /// number of rows whose first detection is wrong.
  std::pair<Cell, Cell> recovered() const {
    std::int64_t known = 0;
    std::int64_t wrong = 0;
    std::int64_t recovered = 0;
    for (const std::size_t i : group_.rows) {
      const double end = table_.number(i, "ends_on_right_mode");
      if (std::isnan(end)) continue;
      ++known;
      if (table_.number(i, "first_detection_wrong") != 1.0) continue;
      ++wrong;
      recovered += end == 1.0 ? 1 : 0;
    }
    if (known == 0) return {};
    return {recovered, wrong};
  }

 private:
  template <class Condition>
  Cell count(const MethodValues& reference, std::string_view column,
             const Condition& condition) const {
    std::int64_t compared = 0;
    std::int64_t count = 0;
    for (const std::size_t i : group_.rows) {
      const auto found = reference.find(table_.key(i));
      const double value = table_.number(i, column);
      if (found == reference.end() || std::isnan(value)) continue;
      ++compared;
      count += condition(value, found->second) ? 1 : 0;
    }
    return compared > 0 ? Cell(count) : Cell();
  }

  const TableReader& table_;
  const MethodRows& group_;
};

}  // namespace

StudyTable summarise_ycbv(const StudyTable& rows) {
  const TableReader table(rows);
  const MethodValues act = values_of(table, kReference, "pixel_median");
  const MethodValues rotation = values_of(table, "odometry", "camera_rotation_rmse_deg");
  const MethodValues position = values_of(table, "odometry", "camera_position_rmse_cm");
  StudyTable summary({"detector", "method", "rows", "pixel_median", "pixel_median_last_map",
                      "better_than_act", "better_than_act_last_map", "compared_with_act",
                      "camera_rotation_over_odometry", "camera_position_over_odometry", "recovered",
                      "first_detection_wrong"});
  for (const MethodRows& group : by_method(table)) {
    const SummaryRow row(table, group);
    const auto [recovered, wrong] = row.recovered();
    summary.add({group.detector, group.method, static_cast<std::int64_t>(group.rows.size()),
                 row.median_of("pixel_median"), row.median_of("pixel_median_last_map"),
                 row.better("pixel_median", act), row.better("pixel_median_last_map", act),
                 row.compared(act), row.over(rotation, "camera_rotation_rmse_deg"),
                 row.over(position, "camera_position_rmse_cm"), recovered, wrong});
  }
  return summary;
}

}  // namespace posemix
