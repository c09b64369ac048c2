// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/density/projected_moments.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/testing/statistics.hpp"
#include "projected_oracle.hpp"

/// Projected Gaussians whose mean is far from the tangent point: rotations of nearly half a turn.
namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Where u ~ N(m, sd^2 I) with |m| = `mean`: the integral of the density of |u| over (1 + u.u)^2 up
/// to `end`, by Simpson's rule.
double radial_integral(double mean, double sd, double end) {
  const auto density = [&](double r) {
    const double z = (r - mean) / sd;
    return r / (mean * sd * std::sqrt(2.0 * std::numbers::pi)) * std::exp(-0.5 * z * z) *
           -std::expm1(-2.0 * r * mean / (sd * sd)) / ((1.0 + r * r) * (1.0 + r * r));
  };
  const double start = std::max(0.0, mean - 12.0 * sd);
  const int n = 200000;
  const double step = (end - start) / n;
  double sum = density(start) + density(end);
  for (int i = 1; i < n; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * density(start + i * step);
  return sum * step / 3.0;
}

double far_end(double mean, double sd) { return mean + 12.0 * sd; }

TEST(FarTangent, TheNormalizerIsTheIntegral) {
  const Vector3d direction = Vector3d(0.6, -0.48, 0.64);
  for (const auto& [mean, sd] : std::vector<std::pair<double, double>>{
           {12.0, 0.01}, {20.0, 5.0}, {100.0, 1.0}, {1000.0, 30.0}, {1e6, 1e-3}, {1e6, 1e3}}) {
    const double found = projected_log_normalizer(mean * direction, sd * sd * Matrix3d::Identity());
    EXPECT_NEAR(found, std::log(radial_integral(mean, sd, far_end(mean, sd))), 1e-9)
        << mean << " " << sd;
  }
  // Of a point: (1 + u.u)^-2.
  EXPECT_NEAR(projected_log_normalizer({1e12, 0, 0}, Matrix3d::Identity()), -4.0 * std::log(1e12),
              1e-10);
}

TEST(FarTangent, IsWhatTheRuleNearTheTangentPointGives) {
  const Matrix3d skewed =
      (Matrix3d() << 0.09, 0.02, 0.0, 0.02, 0.04, -0.01, 0.0, -0.01, 0.16).finished();
  const Vector3d direction = Vector3d(0.6, -0.48, 0.64);
  for (const double scale : {1e-6, 1.0, 100.0}) {
    const Matrix3d covariance = scale * skewed;
    const ProjectedMoments near = projected_moments((10.0 - 1e-12) * direction, covariance);
    const ProjectedMoments far = projected_moments((10.0 + 1e-12) * direction, covariance);
    EXPECT_NEAR(near.log_normalizer, far.log_normalizer, 1e-11) << scale;
    EXPECT_LT((near.mean - far.mean).norm(), 1e-10);
    EXPECT_LT((near.second_moment - far.second_moment).norm(), 1e-8);
    EXPECT_LT((near.rotation - far.rotation).norm(), 1e-11);
  }
}

TEST(FarTangent, SamplesAreOfTheDensityAndNeedNoProposals) {
  Matrix6d covariance = oracle::first_covariance();
  covariance.topLeftCorner<3, 3>() += Matrix3d::Identity();
  Vector6d mean;
  mean << 700.0, -500.0, 300.0, 1.0, -2.0, 0.5;
  const ProjectedGaussian<SE3d> density(SO3d::exp({0.3, -0.2, 0.4}), mean, covariance);
  const DistributionMoments<SE3d> distribution = moments_of(density);
  RandomStream stream(3);
  testing::SampleMoments coordinates(6);
  for (int i = 0; i < 20000; ++i) coordinates.add(density.coordinates(density.sample(stream)));
  EXPECT_LT(coordinates.worst_score(distribution.mean, distribution.covariance), 4.5);
}

/// Where both the tangent point and the mean of the Gaussian are likely.
TEST(FarTangent, SamplesHaveBothModes) {
  const double mean = 60.0;
  const double sd = 14.0;
  const ProjectedGaussian<SO3d> density(SO3d(), Vector3d(0.0, 0.0, mean),
                                        sd * sd * Matrix3d::Identity());
  const double whole = radial_integral(mean, sd, far_end(mean, sd));
  const double near = radial_integral(mean, sd, 5.0) / whole;
  ASSERT_GT(near, 0.1);
  ASSERT_LT(near, 0.9);
  RandomStream stream(5);
  const int draws = 20000;
  int found = 0;
  for (int i = 0; i < draws; ++i) found += density.coordinates(density.sample(stream)).norm() < 5.0;
  EXPECT_NEAR(double(found) / draws, near, 4.5 * std::sqrt(near * (1.0 - near) / draws));
}

}  // namespace
}  // namespace posemix
