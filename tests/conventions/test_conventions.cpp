// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The worked examples of docs/conventions.md, with the numbers on that page.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "posemix/base/units.hpp"
#include "posemix/density/operations.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix {
namespace {

constexpr double kPrinted = 6e-7;  // the page gives six decimals

Vector6d vector6(double a, double b, double c, double d, double e, double f) {
  Vector6d v;
  v << a, b, c, d, e, f;
  return v;
}

SE3d translation(double x, double y, double z) { return SE3d(SO3d(), Eigen::Vector3d(x, y, z)); }

SO3d quarter_turn() { return SO3d::exp(Eigen::Vector3d(0, 0, std::numbers::pi / 2)); }

TEST(Conventions, FramesMapCoordinates) {
  const SE3d t_world_camera(quarter_turn(), Eigen::Vector3d(1, 2, 0.5));
  const Eigen::Vector3d p_world = t_world_camera * Eigen::Vector3d(0.3, 0, 0);
  EXPECT_TRUE(p_world.isApprox(Eigen::Vector3d(1, 2.3, 0.5), 1e-12));
}

TEST(Conventions, TangentIsRotationFirst) {
  const SE3d pose = SE3d::exp(vector6(0, 0, std::numbers::pi / 2, 1, 0, 0));
  EXPECT_TRUE(pose.rotation().is_approx(quarter_turn(), 1e-12));
  EXPECT_NEAR(pose.translation().x(), 0.636620, kPrinted);
  EXPECT_NEAR(pose.translation().y(), 0.636620, kPrinted);
}

TEST(Conventions, PerturbationIsOnTheLeft) {
  const double variance = radians(1.0) * radians(1.0);
  Matrix6d body = Matrix6d::Zero();
  body(2, 2) = variance;
  const Matrix6d reference = translation(10, 0, 0).adjoint_congruence(body);
  EXPECT_NEAR(reference(2, 2), 3.046174e-4, 5e-11);
  EXPECT_NEAR(reference(4, 4), 3.046174e-2, 5e-9);
  EXPECT_NEAR(reference(2, 4), -3.046174e-3, 5e-10);
}

TEST(Conventions, ComposeAddsInTheFrameOfTheStart) {
  Matrix6d small = 1e-18 * Matrix6d::Identity();
  small(2, 2) = radians(2.0) * radians(2.0);
  // Every motion has its own error: a turn about its start, then 1 m along x.
  const ConcentratedGaussian<SE3d> move(translation(1, 0, 0), small);
  const ConcentratedGaussian<SE3d> both = compose(move, move);
  EXPECT_NEAR(both.mean().translation().x(), 2.0, 1e-15);
  EXPECT_NEAR(both.covariance()(4, 4), 1.218470e-3, 5e-10);
}

TEST(Conventions, DensityIsWithRespectToTheHaarMeasure) {
  Matrix6d covariance = Matrix6d::Identity() * 1e-4;
  covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * radians(1.0) * radians(1.0);
  const ConcentratedGaussian<SE3d> density(translation(1, 2, 3), covariance);
  EXPECT_NEAR(density.log_density(density.mean()), 20.446560, kPrinted);
}

TEST(Conventions, ProjectedGaussiansAreOnTheRight) {
  const SO3d tangent_point = quarter_turn();
  const SO3d turned = tangent_point * SO3d::exp({0, 0, radians(20.0)});
  const Eigen::Vector3d u(0, 0, 0.176327);
  EXPECT_NEAR((gnomonic::lift(tangent_point, turned) - u).norm(), 0.0, kPrinted);
  const SO3d minus = SO3d::from_quaternion(Eigen::Quaterniond(-turned.quaternion().coeffs()));
  EXPECT_NEAR((gnomonic::lift(tangent_point, minus) - u).norm(), 0.0, kPrinted);

  Matrix6d covariance = Matrix6d::Identity() * 1e-4;
  covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * radians(0.5) * radians(0.5);
  const ProjectedGaussian<SE3d> density(translation(1, 2, 3), covariance);
  EXPECT_NEAR(density.log_density(density.mean()), 20.447017, kPrinted);
}

TEST(Conventions, WeightsAreNaturalLogarithms) {
  const ConcentratedGaussian<SE3d> density(SE3d(), Matrix6d::Identity());
  const double weights[] = {0.7, 0.3};
  const auto mixture =
      Mixture<ConcentratedGaussian<SE3d>>::from_weights(weights, {density, density});
  EXPECT_NEAR(mixture[0].log_weight, -0.356675, kPrinted);
  EXPECT_NEAR(mixture[1].log_weight, -1.203973, kPrinted);
}

TEST(Conventions, QuaternionsAreXyzw) {
  const Eigen::Vector4d xyzw = quarter_turn().quaternion().coeffs();
  EXPECT_NEAR((xyzw - Eigen::Vector4d(0, 0, 0.707107, 0.707107)).norm(), 0.0, kPrinted);
}

TEST(Conventions, InnovationIsInTheWorldFrame) {
  const PoseStackd mean(std::vector<SE3d>{SE3d(), translation(0, 0, 2)});
  const DetectorNoise noise({NoiseComponent{}});
  const auto residual = [&](const SE3d& detected) {
    return innovation(mean, {1, detected, &noise}, noise.components().front()).residual;
  };
  EXPECT_NEAR((residual(translation(0, 0.02, 2)) - vector6(0, 0, 0, 0, 0.02, 0)).norm(), 0.0,
              1e-12);
  const SE3d turned = translation(0, 0, 2) * SE3d::exp(vector6(0, 0.1, 0, 0, 0, 0));
  EXPECT_NEAR((residual(turned) - vector6(0, 0.1, 0, -0.2, 0, 0)).norm(), 0.0, 1e-12);
}

TEST(Conventions, ErrorsSeparateAngleAndPlace) {
  const SE3d truth = translation(10, 0, 0);
  const SE3d estimate = truth * SE3d::exp(vector6(0, 0, radians(1.0), 0, 0, 0));
  const Vector6d error = (estimate * truth.inverse()).log();
  EXPECT_NEAR(degrees(error.head<3>().norm()), 1.0, 1e-12);
  EXPECT_NEAR((estimate.translation() - truth.translation()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(error.tail<3>().norm(), 0.174533, kPrinted);
}

TEST(Conventions, LeverArmIsOnTheRight) {
  const SE3d annotated(quarter_turn(), Eigen::Vector3d(1, 2, 0.5));
  const SE3d image = annotated * translation(0.0207, 0, 0.0012);
  EXPECT_TRUE(image.translation().isApprox(Eigen::Vector3d(1, 2.0207, 0.5012), 1e-12));
}

}  // namespace
}  // namespace posemix
