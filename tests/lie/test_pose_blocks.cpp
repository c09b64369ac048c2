// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "posemix/lie/pose_blocks.hpp"
#include "posemix/lie/pose_covariance.hpp"

namespace posemix {
namespace {

TEST(PoseBlocks, AreViewsOfSixCoordinatesPerPose) {
  Eigen::MatrixXd m = Eigen::MatrixXd::NullaryExpr(
      18, 18, [](Eigen::Index i, Eigen::Index j) { return static_cast<double>(18 * i + j); });
  const Eigen::MatrixXd before = m;
  EXPECT_EQ(offset(3), 18);
  EXPECT_EQ(rows(before, 1), before.middleRows(6, 6));
  EXPECT_EQ(columns(before, 2), before.rightCols(6));
  EXPECT_EQ(block(before, 0, 2), before.topRightCorner(6, 6));
  block(m, 2, 1).setZero();
  EXPECT_EQ(m.block(12, 6, 6, 6), Eigen::MatrixXd::Zero(6, 6));
  EXPECT_EQ(m.topRows(12), before.topRows(12));
  Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(12, 0.0, 11.0);
  EXPECT_EQ(segment(v, 1), Eigen::VectorXd::LinSpaced(6, 6.0, 11.0));
}

TEST(PoseCovariance, HasTheSquaresOfTheDeviationsRotationFirst) {
  Vector6d squares;
  squares << 0.01, 0.04, 0.09, 1.0, 4.0, 9.0;
  const Matrix6d covariance = pose_covariance({0.1, 0.2, 0.3}, {1.0, 2.0, 3.0});
  EXPECT_TRUE(covariance.isApprox(Matrix6d(squares.asDiagonal()), 1e-15));
}

}  // namespace
}  // namespace posemix
