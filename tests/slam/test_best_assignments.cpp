// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The assignments of least cost, against all assignments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/slam/association.hpp"

namespace posemix {
namespace {

constexpr double kImpossible = 1e6;

/// Costs of all assignments, sorted, by permutations of the columns.
std::vector<double> all_costs(const Eigen::MatrixXd& cost) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(cost.cols()));
  std::iota(columns.begin(), columns.end(), Eigen::Index{0});
  std::vector<double> costs;
  do {
    // Columns that no row takes are in one order alone.
    if (!std::is_sorted(columns.begin() + cost.rows(), columns.end())) continue;
    double sum = 0.0;
    for (Eigen::Index row = 0; row < cost.rows(); ++row)
      sum += cost(row, columns[static_cast<std::size_t>(row)]);
    if (sum < kImpossible) costs.push_back(sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  std::sort(costs.begin(), costs.end());
  return costs;
}

Eigen::MatrixXd random_cost(std::uint64_t seed, Eigen::Index rows, Eigen::Index columns) {
  RandomStream stream(seed, 3);
  Eigen::MatrixXd cost(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j)
      cost(i, j) = stream.uniform() < 0.2 ? kImpossible : 10.0 * stream.uniform();
  }
  return cost;
}

TEST(BestAssignments, AreThoseOfAnEnumeration) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto rows = static_cast<Eigen::Index>(1 + seed % 4);
    const Eigen::MatrixXd cost =
        random_cost(seed, rows, rows + static_cast<Eigen::Index>(seed % 3));
    const std::vector<double> expected = all_costs(cost);
    const std::vector<Assignment> found = best_assignments(cost, 1000, kImpossible);
    ASSERT_EQ(found.size(), expected.size()) << seed;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k].cost, expected[k], 1e-12);
      // No column twice, and no assignment twice.
      std::vector<Eigen::Index> columns = found[k].columns;
      std::sort(columns.begin(), columns.end());
      EXPECT_EQ(std::adjacent_find(columns.begin(), columns.end()), columns.end());
      for (std::size_t other = 0; other < k; ++other)
        EXPECT_NE(found[k].columns, found[other].columns);
    }
    EXPECT_EQ(best_assignments(cost, 2, kImpossible).size(),
              std::min<std::size_t>(2, expected.size()));
  }
}

TEST(BestAssignments, ProbabilitiesAreThoseOfAllAssignments) {
  Eigen::MatrixXd cost(2, 4);
  cost << 1.0, 3.0, 9.0, kImpossible,  //
      2.0, 1.5, kImpossible, 9.0;
  const auto all = best_assignments(cost, 100, kImpossible);
  const Eigen::MatrixXd probability = association_probabilities(all, 2);
  double total = 0.0;
  double first = 0.0;
  for (const Assignment& one : all) {
    total += std::exp(-0.5 * one.cost);
    if (one.columns[0] == 0) first += std::exp(-0.5 * one.cost);
  }
  EXPECT_NEAR(probability(0, 0), first / total, 1e-12);
  EXPECT_LT(probability.rowwise().sum().maxCoeff(), 1.0);
  EXPECT_LE(probability.colwise().sum().maxCoeff(), 1.0 + 1e-12);
}

}  // namespace
}  // namespace posemix
