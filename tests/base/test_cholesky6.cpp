// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "base/cholesky6.hpp"
#include "posemix/base/random.hpp"

namespace posemix::internal {
namespace {

Matrix6d random_covariance6(RandomStream& random, double scale) {
  Matrix6d root;
  for (double& x : root.reshaped()) x = scale * random.normal();
  return root * root.transpose() + 1e-3 * scale * scale * Matrix6d::Identity();
}

Vector6d random_vector(RandomStream& random) {
  Vector6d z;
  for (double& x : z) x = random.normal();
  return z;
}

TEST(Cholesky6, SolvesAsEigenDoes) {
  RandomStream random(1);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix6d s = random_covariance6(random, scale);
      const Eigen::LLT<Matrix6d> expected(s);
      const Vector6d z = random_vector(random);
      const Cholesky6 factor(s);
      ASSERT_TRUE(factor.ok());
      EXPECT_NEAR(factor.log_det(), log_det(expected), 1e-9);
      // The condition of these matrices is up to 1e5.
      const double rounding = 1e-10;
      const Vector6d white = expected.matrixL().solve(z);
      EXPECT_LT((factor.whitened(z) - white).norm(), rounding * white.norm());
      const Vector6d solved = expected.solve(z);
      EXPECT_LT((factor.solved(z) - solved).norm(), rounding * solved.norm());
    }
  }
}

TEST(Cholesky6, ADirectionWithoutVarianceAddsNothing) {
  RandomStream random(2);
  for (Eigen::Index known = 0; known < 6; ++known) {
    for (const double left : {0.0, -1e-18, -std::numeric_limits<double>::denorm_min()}) {
      Matrix6d s = random_covariance6(random, 1.0);
      s.row(known).setZero();
      s.col(known).setZero();
      s(known, known) = left;
      Vector6d z = random_vector(random);
      const Cholesky6 factor(s);
      EXPECT_FALSE(factor.ok());
      // The oracle: the same without the direction.
      Matrix6d rest = s;
      rest(known, known) = 1.0;
      Vector6d others = z;
      others[known] = 0.0;
      const Vector6d expected = Eigen::LLT<Matrix6d>(rest).solve(others);
      EXPECT_LT((factor.solved(z) - expected).norm(), 1e-10 * expected.norm());
    }
  }
}

}  // namespace
}  // namespace posemix::internal
