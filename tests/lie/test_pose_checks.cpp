// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <gtest/gtest.h>

#include "numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"
#include "posemix/lie/pose_checks.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::thrown_message;

using testing::kInf;
using testing::kNan;

TEST(PoseChecks, APoseIsFiniteAndNotTooFar) {
  EXPECT_NO_THROW(check_pose(SE3d(SO3d(), {1e8, -1e8, 0.0}), "it"));
  EXPECT_EQ(thrown_message([] {
              check_pose(SE3d(SO3d(), {0.0, -1.1e8, 0.0}), "it");
            }),
            "it has a position of 1.1e+08 m, expected at most 1e+08 m");
  for (const double value : {kNan, kInf, -kInf}) {
    EXPECT_EQ(thrown_message([&] {
                check_pose(SE3d(SO3d(), {0.0, value, 0.0}), "it");
              }),
              "it holds a value that is not finite");
    for (int i = 0; i < 3; ++i)
      EXPECT_FALSE(is_valid_pose(SE3d(SO3d(), value * Eigen::Vector3d::Unit(i)))) << i << value;
  }
  EXPECT_TRUE(is_valid_pose(SE3d(SO3d(), {1e8, -1e8, 0.0})));
  EXPECT_FALSE(is_valid_pose(SE3d(SO3d(), {0.0, -1.1e8, 0.0})));
}

TEST(PoseChecks, VariancesHaveABound) {
  const Matrix6d one = Matrix6d::Identity();
  EXPECT_NO_THROW(check_variances(1e16 * one, "it"));
  EXPECT_EQ(thrown_message([&] { check_variances(1e17 * one, "it"); }),
            "it has a variance of 1e+17, expected at most 1e+16 (rad^2, m^2)");
  EXPECT_EQ(thrown_message([&] { check_variances(kNan * one, "it"); }),
            "it holds a value that is not finite");
}

TEST(PoseChecks, ANoiseMayBeZeroInSomeDirections) {
  EXPECT_NO_THROW(check_noise(Matrix6d::Zero(), "it"));
  RandomStream stream(1);
  for (int k = 0; k < 200; ++k) {
    // Of any rank below six, with standard deviations over twelve decades.
    Matrix6d root = Matrix6d::Zero();
    for (int j = 0; j < k % 6; ++j) {
      for (int i = 0; i < 6; ++i) root(i, j) = stream.normal();
    }
    for (int i = 0; i < 6; ++i) root.row(i) *= std::pow(10.0, 12.0 * stream.uniform() - 6.0);
    EXPECT_NO_THROW(check_noise(root * root.transpose(), "it")) << root;
  }
}

TEST(PoseChecks, ANoiseHasNoNegativeVarianceInAnyDirection) {
  const auto refused = [](const Matrix6d& noise) {
    return thrown_message([&] { check_noise(noise, "it"); });
  };
  Matrix6d noise = Matrix6d::Identity();
  noise(4, 4) = -1e-300;
  EXPECT_EQ(refused(noise), "it has a negative variance");
  noise(4, 4) = 1.0;
  noise(0, 5) = 0.1;
  EXPECT_EQ(refused(noise), "it is not symmetric");
  // An error in common of two directions that is larger than the errors themselves, whatever the
  // units of the two.
  for (const double unit : {1e-8, 1.0, 1e6}) {
    noise = Matrix6d::Identity();
    noise.row(5) *= unit;
    noise.col(5) *= unit;
    noise(0, 5) = noise(5, 0) = 1.001 * unit;
    EXPECT_EQ(refused(noise), "it is not positive semidefinite") << unit;
    noise(0, 5) = noise(5, 0) = unit;
    EXPECT_NO_THROW(check_noise(noise, "it")) << unit;
  }
  noise = Matrix6d::Identity();
  noise(2, 2) = 0.0;
  noise(2, 3) = noise(3, 2) = 0.01;
  EXPECT_EQ(refused(noise), "it is not positive semidefinite");
  // Rounding beside the largest entry, and not beside the two variances: what counts is the mean of
  // the two mirror images.
  noise = Matrix6d::Identity();
  noise(4, 4) = 1e10;
  for (const double entry : {1.9, 2.1}) {
    for (const bool above : {false, true}) {
      noise(0, 5) = above ? entry : 0.0;
      noise(5, 0) = above ? 0.0 : entry;
      if (entry < 2.0)
        EXPECT_NO_THROW(check_noise(noise, "it")) << above;
      else
        EXPECT_EQ(refused(noise), "it is not positive semidefinite") << above;
    }
  }
  // Beside a variance of zero an entry is rounding in the units of its own row, whatever the
  // largest one is.
  noise = Matrix6d::Identity();
  noise(4, 4) = 1e10;
  noise(2, 2) = 0.0;
  noise(2, 3) = noise(3, 2) = 1e-3;
  EXPECT_EQ(refused(noise), "it is not positive semidefinite");
  noise(2, 3) = noise(3, 2) = 1e-5;
  EXPECT_NO_THROW(check_noise(noise, "it"));
  // What counts as rounding beside a variance of zero is a part of the largest entry, in any units.
  for (const double unit : {1e-6, 1.0, 1e6}) {
    noise = unit * Matrix6d::Identity();
    noise(2, 2) = 0.0;
    noise(2, 3) = noise(3, 2) = 1e-8 * unit;
    EXPECT_EQ(refused(noise), "it is not positive semidefinite") << unit;
    noise(2, 3) = noise(3, 2) = 1e-10 * unit;
    EXPECT_NO_THROW(check_noise(noise, "it")) << unit;
  }
}

}  // namespace
}  // namespace posemix
