// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/density/projected_operations.hpp"
#include "projected_oracle.hpp"

// Oracles: numpy prototypes of the formulas and, where noted, importance sampling. Their overlaps
// are with respect to the half sphere of quaternions: log 8 more than with the Haar measure.
namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using gnomonic::kLogHaarPerHalfSphere;

constexpr ProjectedFuseSettings kJacobian{.rule = FusionRule::jacobian};

ProjectedGaussian<SE3d> first() {
  return oracle::gaussian(Vector3d::Zero(), Vector3d::Zero(), oracle::first_covariance());
}
ProjectedGaussian<SE3d> second() {
  return oracle::gaussian({0.2, -0.1, 0.3}, {0.02, 0.01, -0.03}, oracle::second_covariance());
}

ProjectedGaussian<SO3d> isotropic(const Vector3d& rotation_vector, double std_u) {
  return {SO3d::exp(rotation_vector), std_u * std_u * Matrix3d::Identity()};
}

TEST(ProjectedFuse, OracleCovariancesHaveTheirNormalizers) {
  EXPECT_NEAR(std::exp(first().log_normalizer()), 0.914013391953832, 1e-12);
  EXPECT_NEAR(std::exp(second().log_normalizer()), 0.942602015205077, 1e-12);
}

TEST(ProjectedFuse, ModeAgreesWithTheOracle) {
  const auto fused = fuse(first(), second());
  EXPECT_TRUE(fused.converged);
  EXPECT_FALSE(fused.second.has_value());
  const SE3d mode = fused.density.mean();
  EXPECT_LT(oracle::quaternion_distance(mode.rotation(), {0.9928399036181865, 0.0570884835831512,
                                                          -0.0359301572538996, 0.0985842514061756}),
            1e-12);
  EXPECT_LT(
      (mode.translation() - Vector3d(0.003035896018128, 0.000983549702865, -0.007443841934439))
          .norm(),
      1e-12);
  Vector6d diagonal;
  diagonal << 0.006215423874184, 0.006083489533125, 0.005873371999575, 0.000422249281178,
      0.000436469694845, 0.000456489539499;
  EXPECT_LT((fused.density.covariance().diagonal() - diagonal).norm(), 1e-12);
  EXPECT_NEAR(fused.log_overlap + kLogHaarPerHalfSphere, 8.206498860216, 1e-9);
  // Importance sampling: 8.20629 +- .0003.
  EXPECT_NEAR(fused.log_overlap + kLogHaarPerHalfSphere, 8.20629, 0.001);
}

TEST(ProjectedFuse, JacobianAgreesWithTheOracle) {
  const auto fused = fuse(first(), second(), kJacobian);
  const SE3d mode = fused.density.mean();
  EXPECT_LT(oracle::quaternion_distance(mode.rotation(), {0.9927518878659121, 0.0574833103379132,
                                                          -0.036214176706362, 0.0991357230101395}),
            1e-12);
  EXPECT_LT(
      (mode.translation() - Vector3d(0.003039842201628, 0.000973144803931, -0.007446828726588))
          .norm(),
      1e-12);
  Vector6d diagonal;
  diagonal << 0.006379011604783, 0.006215410697491, 0.006093472631250, 0.000422356860824,
      0.000436729391254, 0.000456570244184;
  EXPECT_LT((fused.density.covariance().diagonal() - diagonal).norm(), 1e-12);
  EXPECT_NEAR(fused.log_overlap + kLogHaarPerHalfSphere, 8.263683751931, 1e-9);
}

TEST(ProjectedFuse, OverlapOfTheGaussiansAgreesWithTheOracle) {
  const SO3d halfway = gnomonic::halfway(first().tangent_point(), second().tangent_point());
  const auto p = change_chart(first(), halfway), q = change_chart(second(), halfway);
  const Eigen::LLT<Matrix6d> sum(p.covariance() + q.covariance());
  const Vector6d apart = q.tangent_mean() - p.tangent_mean();
  EXPECT_NEAR(-0.5 * sum.matrixL().solve(apart).squaredNorm(), -1.224793534406, 1e-11);
  EXPECT_NEAR(log_normal(sum, apart), 8.117484487680, 1e-11);
}

TEST(ProjectedFuse, JacobianRefusesBeyondItsLimit) {
  const auto at = [](double degrees_of_rotation) {
    return isotropic({radians(degrees_of_rotation), 0.0, 0.0}, 0.1);
  };
  EXPECT_NO_THROW(fuse(at(0.0), at(29.9), kJacobian));
  EXPECT_THROW(fuse(at(0.0), at(30.1), kJacobian), InvalidInput);
  EXPECT_NO_THROW(fuse(at(0.0), at(359.0), kJacobian)) << "q and -q are the same tangent point";
  EXPECT_NO_THROW(fuse(at(0.0), at(120.0)));
}

TEST(ProjectedFuse, IsExactOnACommonTangentPoint) {
  // Eq. 14: with one tangent point the product of the Gaussians is a Gaussian.
  const auto p = first();
  const auto q = ProjectedGaussian<SE3d>(SO3d(), p.tangent_mean(), oracle::second_covariance());
  for (const auto& settings : {ProjectedFuseSettings{}, kJacobian}) {
    const auto fused = fuse(p, q, settings);
    const Matrix6d expected = (p.covariance().inverse() + q.covariance().inverse()).inverse();
    EXPECT_LT((fused.density.covariance() - expected).norm(), 1e-12);
    const SE3d at = SE3d::exp(Vector6d::Constant(0.05));
    EXPECT_NEAR(p.log_density(at) + q.log_density(at),
                fused.log_overlap + fused.density.log_density(at), 1e-9);
  }
}

/// The log of the integral of p q over the rotations, by sampling from p, with its standard error.
std::pair<double, double> sampled_overlap(const ProjectedGaussian<SO3d>& p,
                                          const ProjectedGaussian<SO3d>& q, int samples) {
  RandomStream stream(7);
  const ProjectedGaussian<SO3d>::Evaluator evaluator(q);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double value = std::exp(evaluator.log_density(p.sample(stream)));
    sum += value;
    squares += value * value;
  }
  const double mean = sum / samples;
  return {std::log(mean), std::sqrt((squares / samples - mean * mean) / samples) / mean};
}

TEST(ProjectedFuse, OverlapAgreesWithSamplingAtAnyAngle) {
  for (const double angle : {10.0, 40.0, 70.0, 100.0}) {
    const Vector3d axis(0.6, 0.0, 0.8);
    const auto p = isotropic(Vector3d::Zero(), 0.25);
    Matrix3d covariance = Vector3d(0.09, 0.02, 0.04).asDiagonal();
    covariance(0, 1) = covariance(1, 0) = 0.01;
    const ProjectedGaussian<SO3d> q(SO3d::exp(radians(angle) * axis), covariance);
    const auto fused = fuse(p, q);
    EXPECT_TRUE(fused.converged);
    const auto [sampled, error] = sampled_overlap(p, q, 200000);
    EXPECT_NEAR(fused.log_overlap, sampled, 0.02 + 4.0 * error) << angle;
  }
}

TEST(ProjectedFuse, FindsTheSecondMode) {
  // Isotropic with 40 degrees of rotation standard deviation: log ratios of the product at its two
  // modes for half angles of 75, 80, 85, 88 degrees from a numpy prototype.
  const double std_u = 0.5 * radians(40.0);
  const double ratio[][2] = {{75.0, 9.1}, {80.0, 5.9}, {85.0, 2.9}, {88.0, 1.1}};
  for (const auto& [half_angle, expected] : ratio) {
    const auto p = isotropic(Vector3d::Zero(), std_u);
    const auto q = isotropic({radians(2.0 * half_angle), 0.0, 0.0}, std_u);
    const auto fused = fuse(p, q, {.second_mode_from = 1e-6});
    ASSERT_TRUE(fused.second.has_value()) << half_angle;
    const auto log_product = [&](const SO3d& at) { return p.log_density(at) + q.log_density(at); };
    EXPECT_NEAR(log_product(fused.density.mean()) - log_product(fused.second->density.mean()),
                expected, 0.06)
        << half_angle;
    const double both = std::log(std::exp(fused.log_overlap) + std::exp(fused.second->log_overlap));
    const auto [sampled, error] = sampled_overlap(p, q, 400000);
    EXPECT_NEAR(both, sampled, 0.05 + 4.0 * error) << half_angle;
  }
  EXPECT_FALSE(fuse(isotropic(Vector3d::Zero(), std_u), isotropic({1.0, 0.0, 0.0}, std_u))
                   .second.has_value());
}

TEST(ProjectedFuse, ModeIsStationaryWhateverTheSigns) {
  const auto p = oracle::gaussian({2.9, 0.3, -0.5}, {1.0, 2.0, 3.0}, oracle::first_covariance());
  const auto q = oracle::gaussian({-2.9, 0.2, 0.9}, {1.1, 2.0, 2.9}, oracle::second_covariance());
  const auto fused = fuse(p, q);
  ASSERT_TRUE(fused.converged);
  const auto product = [&](const Vector6d& y) {
    Vector6d shifted = y;
    shifted.tail<3>() += fused.density.tangent_mean().tail<3>();
    const SE3d at = fused.density.element(shifted);
    return p.log_density(at) + q.log_density(at);
  };
  for (int i = 0; i < 6; ++i) {
    const double h = 1e-4;
    const double up = product(h * Vector6d::Unit(i)), down = product(-h * Vector6d::Unit(i));
    EXPECT_NEAR((up - down) / (2.0 * h), 0.0, 1e-4);
    const double curvature = -(up - 2.0 * product(Vector6d::Zero()) + down) / (h * h);
    EXPECT_NEAR(curvature / fused.density.covariance().inverse()(i, i), 1.0, 1e-4);
  }
}

TEST(ProjectedFuse, RefusesSettingsOutOfRange) {
  EXPECT_THROW(fuse(first(), second(), {.max_iterations = 0}), InvalidInput);
  EXPECT_THROW(fuse(first(), second(), {.second_mode_from = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace posemix
