// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/testing/rotation_quadrature.hpp"

/// A density on SO(3) integrates to one minus the Gaussian mass outside the ball |xi| <= pi.
namespace posemix {
namespace {

using testing::BallRule;

double integral(const ConcentratedGaussian<SO3d>& density, const SO3d& centre,
                const BallRule& rule) {
  const ConcentratedGaussian<SO3d>::Evaluator evaluator(density);
  return rule.integrate(centre, [&](const SO3d& x) { return std::exp(evaluator.log_density(x)); });
}

/// Mass of N(0, s^2 I) in three dimensions inside the radius r: the chi distribution of three
/// degrees of freedom, in closed form.
double isotropic_mass(double s, double r) {
  const double z = r / s;
  return std::erf(z / std::sqrt(2.0)) -
         std::sqrt(2.0 / std::numbers::pi) * z * std::exp(-0.5 * z * z);
}

/// Mass of N(0, diag(across^2, across^2, along^2)) inside the radius r: a slice at height z holds
/// 1 - exp(-(r^2 - z^2) / (2 across^2)) of its mass.
double axial_mass(double across, double along, double r) {
  double mass = 0.0;
  for (const auto& z : testing::gauss_legendre(-r, r, 20)) {
    const double slice = -std::expm1(-(r * r - z.at * z.at) / (2.0 * across * across));
    const double height = std::exp(-0.5 * z.at * z.at / (along * along)) /
                          (along * std::sqrt(2.0 * std::numbers::pi));
    mass += z.weight * slice * height;
  }
  return mass;
}

TEST(BallRule, HaarVolumeOfAllRotations) {
  // Integral of 2 (1 - cos r) dr over the unit sphere and [0, pi]: 8 pi^2.
  const double volume = BallRule{}.integrate(SO3d(), [](const SO3d&) { return 1.0; });
  EXPECT_NEAR(volume, 8.0 * std::numbers::pi * std::numbers::pi, 1e-10);
}

TEST(BallRule, HarmonicsIntegrateToZero) {
  // The trace of a rotation is the character of an irreducible representation other than the
  // trivial one, so it integrates to zero around any centre.
  const SO3d centre = SO3d::exp({0.4, -1.0, 0.3});
  const double trace =
      BallRule{}.integrate(centre, [](const SO3d& x) { return x.matrix().trace(); });
  EXPECT_NEAR(trace, 0.0, 1e-10);
}

class IsotropicIntegral : public ::testing::TestWithParam<double> {};

TEST_P(IsotropicIntegral, IsOneUpToTheMassOutside) {
  const double s = GetParam();
  const SO3d mean = SO3d::exp({1.0, 0.5, -2.0});
  const ConcentratedGaussian<SO3d> density(mean, s * s * Eigen::Matrix3d::Identity());
  const BallRule rule{.radial_panels = 8, .polar_panels = 1, .azimuths = 2};
  EXPECT_NEAR(integral(density, mean, rule), isotropic_mass(s, std::numbers::pi), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Deviations, IsotropicIntegral,
                         ::testing::Values(0.05, 0.3, 0.8, 1.5, 3.0));

TEST(DensityIntegral, AnisotropicIsOne) {
  // The largest standard deviation, 0.42 rad, leaves less than 1e-12 outside (7.4 deviations).
  const Eigen::Matrix3d axes = SO3d::exp({0.7, -0.2, 1.3}).matrix();
  const Eigen::Vector3d deviations(0.42, 0.2, 0.12);
  const Eigen::Matrix3d covariance = axes * deviations.cwiseAbs2().asDiagonal() * axes.transpose();
  const SO3d mean = SO3d::exp({-1.0, 2.0, 0.4});
  const BallRule rule{.radial_panels = 3, .polar_panels = 3, .azimuths = 150};
  EXPECT_NEAR(integral({mean, covariance}, mean, rule), 1.0, 1e-11);
}

TEST(DensityIntegral, ElongatedLosesTheMassOutsideTheBall) {
  // A near-symmetry axis: 1.2 rad about z, 0.3 rad across.
  const Eigen::Vector3d deviations(0.3, 0.3, 1.2);
  const Eigen::Matrix3d covariance = deviations.cwiseAbs2().asDiagonal();
  const BallRule rule{.radial_panels = 3, .polar_panels = 4, .azimuths = 2};
  const double expected = axial_mass(0.3, 1.2, std::numbers::pi);
  EXPECT_LT(expected, 0.995);
  EXPECT_NEAR(integral({SO3d(), covariance}, SO3d(), rule), expected, 1e-11);
}

TEST(DensityIntegral, DoesNotDependOnTheCentreOfTheRule) {
  Eigen::Matrix3d covariance;
  covariance << 0.09, 0.02, -0.01, 0.02, 0.06, 0.03, -0.01, 0.03, 0.04;
  const SO3d mean = SO3d::exp({0.5, 0.3, -0.2});
  const BallRule rule{.radial_panels = 4, .polar_panels = 4, .azimuths = 150};
  EXPECT_NEAR(integral({mean, covariance}, SO3d(), rule), 1.0, 1e-9);
}

}  // namespace
}  // namespace posemix
