// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "em_draws.hpp"
#include "posemix/mixture/projected_mixture.hpp"

namespace posemix {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180.0;

struct WeightedRotations {
  std::vector<SO3d> rotations;
  std::vector<double> weights;
};

WeightedRotations random_rotations(int count, double reach, RandomStream& stream) {
  WeightedRotations drawn;
  for (int i = 0; i < count; ++i) {
    drawn.rotations.push_back(testing::random_element<SO3d>(reach, stream));
    drawn.weights.push_back(0.1 + stream.uniform());
  }
  return drawn;
}

TEST(GnomonicMean, IsWhereTheMeanOfUVanishes) {
  RandomStream stream(2);
  for (int trial = 0; trial < 20; ++trial) {
    const WeightedRotations of = random_rotations(5, 0.6, stream);
    const MeanResult<SO3d> mean = gnomonic_mean(of.rotations, of.weights);
    EXPECT_TRUE(mean.converged);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 5; ++i) {
      sum += of.weights[i] * gnomonic::lift(mean.mean, of.rotations[i]);
    }
    EXPECT_LT(sum.norm(), 1e-11);
  }
}

TEST(GnomonicMean, WhatHasNoWeightMayLieAnywhere) {
  const auto half_turn = SO3d::from_quaternion(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0));
  const MeanResult<SO3d> mean =
      gnomonic_mean(std::vector{SO3d(), half_turn}, std::vector{1.0, 0.0});
  EXPECT_TRUE(mean.converged);
  EXPECT_TRUE(mean.mean.is_approx(SO3d(), 0.0));
}

TEST(TangentMomentsOfProjected, HaveAnExactlySymmetricCovariance) {
  RandomStream stream(5);
  std::vector<Component<testing::Projected<SE3d>>> parts;
  for (int k = 0; k < 4; ++k) {
    parts.push_back({0.0, testing::Projected<SE3d>(testing::random_element<SE3d>(0.4, stream),
                                                   testing::random_covariance<SE3d>(0.5, stream))});
  }
  const Matrix6d covariance = tangent_moments<SE3d>(parts, SO3d()).covariance();
  EXPECT_EQ(covariance, covariance.transpose());
}

TEST(GnomonicMean, OfTwoIsOnTheGeodesicHoweverFarTheyAreApart) {
  for (const double angle : {10.0, 90.0, 170.0, 180.0}) {
    const std::vector rotations{SO3d(), SO3d::exp({0.0, angle * kOneDegree, 0.0})};
    const MeanResult<SO3d> mean = gnomonic_mean(rotations, std::vector{0.7, 0.3});
    EXPECT_TRUE(mean.converged);
    // .7 tan(a / 2) = .3 tan((angle - a) / 2), and no turn about the other axes.
    const Eigen::Vector3d turn = mean.mean.log();
    EXPECT_NEAR(0.7 * std::tan(0.5 * turn.y()),
                0.3 * std::tan(0.5 * (angle * kOneDegree - turn.y())), 1e-11);
    EXPECT_NEAR(turn.x(), 0.0, 1e-13);
    EXPECT_NEAR(turn.z(), 0.0, 1e-13);
  }
}

/// The steps are Newton's: each leaves the square of what was left.
TEST(GnomonicMean, EachStepLeavesTheSquareOfWhatWasLeft) {
  RandomStream stream(1);
  for (int trial = 0; trial < 20; ++trial) {
    const WeightedRotations of = random_rotations(6, 0.7, stream);
    const auto residual = [&](int steps) {
      return gnomonic_mean(of.rotations, of.weights, {.max_iterations = steps, .tolerance = 0.0})
          .residual;
    };
    for (int steps = 0; steps < 4; ++steps)
      EXPECT_LT(residual(steps + 1), 0.5 * std::pow(residual(steps), 2) + 1e-14);
  }
}

/// Quaternions of both signs stand for the rotations: the start is between them all the same.
TEST(GnomonicMean, StartsAtTheSumOfTheQuaternions) {
  const double first = 3.0, second = 3.4;  // rad, on both sides of the change of sign
  const std::vector rotations{SO3d::exp({0.0, first, 0.0}), SO3d::exp({0.0, second, 0.0})};
  for (const double weight : {0.3, 0.8}) {
    const std::vector weights{weight, 1.0 - weight};
    const MeanResult<SO3d> start = gnomonic_mean(rotations, weights, {.max_iterations = 0});
    const double half =
        std::atan2(weight * std::sin(0.5 * first) + (1.0 - weight) * std::sin(0.5 * second),
                   weight * std::cos(0.5 * first) + (1.0 - weight) * std::cos(0.5 * second));
    EXPECT_LT((SO3d::exp({0.0, 2.0 * half, 0.0}).inverse() * start.mean).log().norm(), 1e-14);
    EXPECT_EQ(start.iterations, 0);
  }
}

}  // namespace
}  // namespace posemix
