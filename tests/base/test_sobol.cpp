// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/sobol.hpp"

namespace posemix {
namespace {

TEST(ShiftedSobol, IsSpreadEvenlyUnderEveryShift) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    RandomStream stream(seed);
    ShiftedSobol sobol(6, stream);
    Eigen::VectorXd point(6);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(6);
    double product = 0.0;
    const int count = 1 << 12;
    for (int i = 0; i < count; ++i) {
      sobol.next(point);
      ASSERT_GT(point.minCoeff(), 0.0);
      ASSERT_LT(point.maxCoeff(), 1.0);
      sum += point;
      product += (2.0 * point.array()).prod();
    }
    // Independent points would be off by 0.0045 and 0.02.
    EXPECT_LT((sum / count - Eigen::VectorXd::Constant(6, 0.5)).cwiseAbs().maxCoeff(), 5e-4);
    EXPECT_NEAR(product / count, 1.0, 5e-3);
  }
}

TEST(ShiftedSobol, ShiftsDiffer) {
  RandomStream stream(1);
  ShiftedSobol first(2, stream), second(2, stream);
  Eigen::VectorXd a(2), b(2);
  first.next(a);
  second.next(b);
  EXPECT_GT((a - b).norm(), 1e-6);
}

}  // namespace
}  // namespace posemix
