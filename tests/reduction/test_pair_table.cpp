// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/pair_table.hpp"

#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace posemix {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

TEST(PairTable, KeepsTheOrderOfEqualCostsThroughErasures) {
  internal::PairTable table(6);
  const std::vector<double> equal(6 + 8, 1.0);
  for (std::size_t row = 1; row < 6; ++row) table.set_before(row, equal.data());
  EXPECT_EQ(table.least(), Pair(0, 1));
  EXPECT_FALSE(table.erase(0));
  EXPECT_EQ(table.least(), Pair(0, 1));
  EXPECT_FALSE(table.erase(1));
  // Three of six slots are left: they are renumbered.
  EXPECT_TRUE(table.erase(0));
  EXPECT_EQ(table.slots(), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(table.least(), Pair(0, 1));
  const std::vector<double> costs{0.5, 0.0, 0.25};
  table.set_all(1, costs.data());
  EXPECT_EQ(table.least(), Pair(1, 2));
}

TEST(PairTable, WithoutACostTheFirstTwoArePaired) {
  internal::PairTable table(3);
  const std::vector<double> none(3 + 8, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 1; row < 3; ++row) table.set_before(row, none.data());
  EXPECT_EQ(table.least(), Pair(0, 1));
}

}  // namespace
}  // namespace posemix
