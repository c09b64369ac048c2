// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/lie/lie.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using Eigen::Vector3d;

SO3d about_z(double angle) { return SO3d::exp(Vector3d(0, 0, angle)); }

std::string error_of(const std::vector<SO3d>& elements, const std::vector<double>& weights) {
  return testing::thrown_message([&] { weighted_mean(elements, weights); });
}

TEST(WeightedMean, OfRotationsAboutOneAxis) {
  const auto result =
      weighted_mean(std::vector{about_z(0.2), about_z(0.5), about_z(1.1)}, {1.0, 2.0, 1.0});
  EXPECT_TRUE(result.converged);
  EXPECT_LE(result.residual, 1e-12);
  EXPECT_TRUE(result.mean.is_approx(about_z(0.575), 1e-15));
}

TEST(WeightedMean, IgnoresElementsOfZeroWeight) {
  const auto result =
      weighted_mean(std::vector{about_z(0.2), about_z(3.0), about_z(0.4)}, {1.0, 0.0, 1.0});
  EXPECT_TRUE(result.mean.is_approx(about_z(0.3), 1e-15));
}

TEST(WeightedMean, WeightsNeedNotSumToOne) {
  const std::vector elements{about_z(0.2), about_z(0.5)};
  const auto small = weighted_mean(elements, {1e-200, 3e-200});
  EXPECT_TRUE(small.mean.is_approx(weighted_mean(elements, {0.25, 0.75}).mean, 1e-15));
}

TEST(WeightedMean, FarFromTheOrigin) {
  const Vector3d far(3e6, -5e6, 4e6);
  const std::vector elements{SE3d(about_z(0.3), far + Vector3d(0.01, 0, 0)),
                             SE3d(about_z(0.3), far - Vector3d(0.01, 0, 0))};
  const auto result = weighted_mean(elements, {1.0, 1.0});
  EXPECT_TRUE(result.converged);
  EXPECT_LE((result.mean.translation() - far).norm(), 2e-9);
}

TEST(WeightedMean, TakesSpans) {
  const std::vector elements{about_z(0.2), about_z(0.4)};
  const std::vector<double> weights{1.0, 1.0};
  const auto result =
      weighted_mean(std::span<const SO3d>(elements), std::span<const double>(weights));
  EXPECT_TRUE(result.mean.is_approx(about_z(0.3), 1e-15));
}

TEST(WeightedMean, NoConvergenceIsAStatus) {
  const std::vector elements{SO3d::exp(Vector3d(1, 0, 0)), SO3d::exp(Vector3d(0, 1, 0)),
                             SO3d::exp(Vector3d(0, 0, 1))};
  const auto result = weighted_mean(elements, {1.0, 1.0, 1.0}, {.max_iterations = 1});
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_GT(result.residual, 1e-12);
  EXPECT_TRUE(weighted_mean(elements, {1.0, 1.0, 1.0}).converged);
}

TEST(WeightedMean, RejectsBadInput) {
  const std::vector two{about_z(0.2), about_z(0.4)};
  EXPECT_EQ(error_of({}, {}), "weighted mean of no elements");
  EXPECT_EQ(error_of(two, {1.0}),
            "weighted mean of 2 elements with 1 weights; expected one for each");
  EXPECT_EQ(error_of(two, {1.0, -0.5}),
            "weight 1 of a weighted mean is -0.5; expected a finite number, zero or more");
  EXPECT_EQ(error_of(two, {std::numeric_limits<double>::quiet_NaN(), 1.0}),
            "weight 0 of a weighted mean is nan; expected a finite number, zero or more");
  EXPECT_EQ(error_of(two, {std::numeric_limits<double>::infinity(), 1.0}),
            "weight 0 of a weighted mean is inf; expected a finite number, zero or more");
  EXPECT_EQ(error_of(two, {0.0, 0.0}), "weights of a weighted mean sum to zero");
  EXPECT_EQ(error_of(two, {1.7e308, 1.7e308}), "weights of a weighted mean overflow");
}

TEST(Interpolate, QuarterOfAScrew) {
  const SE3d a(about_z(0.4), Vector3d(1, 2, 3));
  const SE3d b = a * SE3d(about_z(std::numbers::pi / 2), Vector3d(0, 0, 4));
  const SE3d want = a * SE3d(about_z(std::numbers::pi / 8), Vector3d(0, 0, 1));
  EXPECT_TRUE(interpolate(a, b, 0.25).is_approx(want, 1e-15));
}

TEST(Interpolate, KeepsItsDigitsFarFromTheOrigin) {
  const Vector3d far(3e6, -5e6, 4e6);
  const SE3d a(about_z(0.4), far);
  const SE3d b(about_z(0.4), far + Vector3d(0, 0.02, 0));
  EXPECT_LE((interpolate(a, b, 0.5).translation() - far - Vector3d(0, 0.01, 0)).norm(), 2e-9);
}

}  // namespace
}  // namespace posemix
