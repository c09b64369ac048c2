// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/mixture/log_weights.hpp"
#include "posemix/slam/association.hpp"

namespace posemix {
namespace {

/// Assignments that have the pairs of the first `fixed` rows in common, and in none of which a
/// forbidden entry is chosen: what Murty (1968) partitions the rest into.
struct Branch {
  Eigen::MatrixXd cost;  ///< forbidden entries are as impossible as those that were given so
  std::size_t fixed = 0;
  Assignment best = {};
};

struct IsWorse {
  bool operator()(const Branch& a, const Branch& b) const { return a.best.cost > b.best.cost; }
};

/// The best assignment of a part, none where it takes an impossible pair.
bool solve(Branch& part, double impossible) {
  part.best.columns = least_cost_assignment(part.cost);
  part.best.cost = 0.0;
  for (std::size_t row = 0; row < part.best.columns.size(); ++row) {
    const double cost = part.cost(static_cast<Eigen::Index>(row), part.best.columns[row]);
    if (cost >= impossible) return false;
    part.best.cost += cost;
  }
  return true;
}

/// The entry of a row is the only one that can be chosen.
void fix(Branch& part, std::size_t row, double impossible) {
  const auto at = static_cast<Eigen::Index>(row);
  const Eigen::Index column = part.best.columns[row];
  const double kept = part.cost(at, column);
  part.cost.row(at).setConstant(impossible);
  part.cost.col(column).setConstant(impossible);
  part.cost(at, column) = kept;
}

void check_assignment(const Assignment& assignment, std::size_t rows) {
  const auto& columns = assignment.columns;
  require(columns.size() == rows, "assignments are not of as many rows, expected the same");
  require(std::all_of(columns.begin(), columns.end(), [](auto column) { return column >= 0; }),
          "an assignment has a negative column");
}

}  // namespace

std::vector<Assignment> best_assignments(const Eigen::MatrixXd& cost, std::size_t count,
                                         double impossible) {
  require(count > 0, "count is 0, expected at least 1");
  require(!std::isnan(impossible), "impossible is nan, expected a number");
  std::vector<Assignment> found;
  std::priority_queue<Branch, std::vector<Branch>, IsWorse> parts;
  Branch whole{.cost = cost.cwiseMin(impossible)};
  if (solve(whole, impossible)) parts.push(std::move(whole));
  while (!parts.empty() && found.size() < count) {
    Branch part = parts.top();
    parts.pop();
    found.push_back(part.best);
    for (std::size_t row = part.fixed; row < part.best.columns.size(); ++row) {
      Branch next{.cost = part.cost, .fixed = row};
      next.cost(static_cast<Eigen::Index>(row), part.best.columns[row]) = impossible;
      if (solve(next, impossible)) parts.push(std::move(next));
      fix(part, row, impossible);
    }
  }
  return found;
}

Eigen::MatrixXd association_probabilities(std::span<const Assignment> assignments,
                                          Eigen::Index columns) {
  std::vector<double> logs;
  for (const Assignment& one : assignments) logs.push_back(-0.5 * one.cost);
  const auto rows = assignments.empty() ? 0 : assignments.front().columns.size();
  require(columns >= 0, "assignments: the number of columns is negative");
  for (const Assignment& one : assignments) check_assignment(one, rows);
  const double total = log_sum_exp(logs);
  Eigen::MatrixXd probability = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows), columns);
  for (std::size_t k = 0; k < assignments.size(); ++k) {
    for (std::size_t row = 0; row < rows; ++row) {
      const Eigen::Index column = assignments[k].columns[row];
      if (column < columns)
        probability(static_cast<Eigen::Index>(row), column) += std::exp(logs[k] - total);
    }
  }
  return probability;
}

}  // namespace posemix
