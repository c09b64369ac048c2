// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/statistics.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"
#include "posemix/base/random.hpp"

namespace posemix {
namespace {

TEST(Statistics, MeanAndItsError) {
  const std::array values{1.0, 2.0, 3.0, 6.0};
  const MeanWithError result = mean_with_error(values);
  EXPECT_DOUBLE_EQ(result.mean, 3.0);
  EXPECT_DOUBLE_EQ(result.standard_error, std::sqrt(14.0 / 3.0 / 4.0));
  EXPECT_TRUE(std::isnan(mean_with_error(std::array{1.0}).standard_error));
}

TEST(Statistics, Median) {
  EXPECT_DOUBLE_EQ(median(std::array{3.0, 1.0, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(median(std::array{4.0, 1.0, 2.0, 3.0}), 2.5);
}

// With two degrees of freedom the distribution function is 1 - exp(-x / 2).
TEST(Statistics, ChiSquareQuantilesOfTwoDegreesOfFreedom) {
  for (const double p : {0.05, 0.5, 0.997}) {
    EXPECT_NEAR(chi_square_quantile(p, 2), -2.0 * std::log1p(-p), 1e-12);
  }
  EXPECT_THROW(chi_square_quantile(1.0, 2), InvalidInput);
  EXPECT_THROW(chi_square_quantile(0.5, 0), InvalidInput);
}

// By inversion of the characteristic function (Imhof 1961) with SciPy 1.15's quad and brentq.
TEST(Statistics, NormOfAGaussian) {
  const double share = std::erf(3.0 / std::sqrt(2.0));
  const auto norm = [&](double a, double b, double c) {
    return gaussian_norm_quantile(Eigen::Vector3d(a, b, c).asDiagonal(), share);
  };
  EXPECT_NEAR(norm(1.0, 1.0, 1.0), 3.76250, 1e-5);
  EXPECT_NEAR(norm(4.0, 0.0, 0.0), 6.0, 1e-9);
  EXPECT_NEAR(norm(4.0, 1.0, 0.25), 6.11820, 0.006 * 6.1);
  EXPECT_NEAR(norm(9.0, 9.0, 0.01), 10.31838, 0.006 * 10.3);
  EXPECT_NEAR(norm(1.0, 0.5, 0.5), 3.23791, 0.006 * 3.2);
  EXPECT_NEAR(norm(25.0, 1.0, 1.0), 15.06802, 0.006 * 15.0);
  EXPECT_EQ(norm(0.0, 0.0, 0.0), 0.0);
  // In any unit: the sixth powers of these overflow, or are zero.
  for (const double scale : {0x1p600, 0x1p-600})
    EXPECT_EQ(norm(4.0 * scale, scale, 0.25 * scale), std::sqrt(scale) * norm(4.0, 1.0, 0.25));
  EXPECT_THROW(gaussian_norm_quantile(Eigen::Matrix2d::Identity(), 1.0), InvalidInput);
  EXPECT_THROW(norm(1.0, NAN, 1.0), InvalidInput);
  EXPECT_THROW(gaussian_norm_quantile(Eigen::MatrixXd::Zero(2, 3), share), InvalidInput);
}

// Bands of 100 runs as in the notes on the Monte-Carlo study: 1200 and 600 degrees of freedom.
TEST(Statistics, ChiSquareBands) {
  const auto state = chi_square_band(100, 12);
  EXPECT_NEAR(state.first, 0.922, 5e-4);
  EXPECT_NEAR(state.second, 1.082, 5e-4);
  const auto relative = chi_square_band(100, 6);
  EXPECT_NEAR(relative.first, 0.890, 1e-3);
  EXPECT_NEAR(relative.second, 1.117, 1e-3);
}

// By hand: differences 1, 2, 3, t = 2 sqrt(3), two degrees of freedom, for which
// P(|T| > t) = 1 - t / sqrt(2 + t^2).
TEST(Statistics, PairedTestByHand) {
  const PairedTest test = paired_test(std::array{2.0, 4.0, 6.0}, std::array{1.0, 2.0, 3.0});
  const double t = 2.0 * std::sqrt(3.0);
  EXPECT_DOUBLE_EQ(test.mean_difference, 2.0);
  EXPECT_DOUBLE_EQ(test.standard_error, 1.0 / std::sqrt(3.0));
  EXPECT_NEAR(test.p_value, 1.0 - t / std::sqrt(2.0 + t * t), 1e-14);
}

TEST(Statistics, PairedTestOfEqualSamples) {
  const std::array same{1.0, 2.0};
  EXPECT_EQ(paired_test(same, same).p_value, 1.0);
  EXPECT_THROW(paired_test(same, std::array{1.0}), InvalidInput);
}

// The p-value of equal means is uniform: about 5 % of it lies below 0.05.
TEST(Statistics, PairedTestHasItsLevel) {
  RandomStream stream(7);
  int rejected = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::vector<double> a(8);
    std::vector<double> b(8);
    for (double& value : a) value = stream.normal();
    for (double& value : b) value = stream.normal();
    if (paired_test(a, b).p_value < 0.05) ++rejected;
  }
  EXPECT_NEAR(rejected, 200, 4 * std::sqrt(4000 * 0.05 * 0.95));
}

}  // namespace
}  // namespace posemix
