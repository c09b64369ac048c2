// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/density/projected_moments.hpp"
#include "posemix/lie/lie.hpp"

// Oracles: numpy prototypes, by sampling and quadrature of other forms of the same integrals;
// oracles of more than 15 digits by mpmath's quadrature with 40 digits.
namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double normalizer(const Vector3d& mean, const Matrix3d& covariance) {
  return std::exp(projected_log_normalizer(mean, covariance));
}

Matrix3d diagonal(double a, double b, double c) { return Vector3d(a, b, c).asDiagonal(); }

Matrix3d skewed() {
  return (Matrix3d() << 0.09, 0.02, 0.0, 0.02, 0.04, -0.01, 0.0, -0.01, 0.16).finished();
}

void expect_relative(double actual, double expected, double tolerance) {
  EXPECT_NEAR(actual / expected, 1.0, tolerance) << actual << " against " << expected;
}

TEST(ProjectedNormalizer, AgreesWithTheOraclesToTwelveDigits) {
  const Vector3d zero = Vector3d::Zero();
  const Matrix3d identity = Matrix3d::Identity();
  expect_relative(normalizer(zero, 0.01 * identity), 0.94412182246203046, 1e-12);
  expect_relative(normalizer(zero, 0.1 * identity), 0.64318294496416539, 1e-12);
  expect_relative(normalizer(zero, identity), 0.15567954241879847, 1e-12);
  expect_relative(normalizer(zero, 100.0 * identity), 5.3542751180746185e-4, 1e-12);
  expect_relative(normalizer(zero, diagonal(0.25, 0.01, 0.0025)), 0.720050263901318, 1e-12);
  expect_relative(normalizer({0.3, -0.2, 0.1}, diagonal(0.25, 0.01, 0.0025)), 0.616058785120331,
                  1e-12);
  expect_relative(normalizer({0.5, 0.0, -1.0}, diagonal(4.0, 0.5, 0.001)), 0.072922686659639725,
                  1e-12);
  expect_relative(normalizer(zero, diagonal(1e4, 1.0, 1e-6)), 0.0035396800654718870, 1e-12);
  expect_relative(normalizer(zero, skewed()), 0.660187379067032, 1e-12);
  expect_relative(normalizer({0.1, -0.2, 0.05}, skewed()), 0.613735711835063, 1e-12);
}

TEST(ProjectedNormalizer, HasItsLimits) {
  const Matrix3d tiny = 1e-9 * Matrix3d::Identity();
  EXPECT_NEAR(normalizer(Vector3d::Zero(), tiny), 1.0 - 6e-9, 1e-14);
  const Vector3d far(2.0, -1.0, 2.0);
  EXPECT_NEAR(normalizer(far, tiny), 1.0 / 100.0, 1e-9);
  const Matrix3d turn = SO3d::exp({0.4, -1.1, 0.7}).matrix();
  expect_relative(normalizer(turn * far, turn * skewed() * turn.transpose()),
                  normalizer(far, skewed()), 1e-13);
}

TEST(ProjectedMoments, AgreeWithTheOracles) {
  const ProjectedMoments centred = projected_moments(Vector3d::Zero(), skewed());
  const Matrix3d second =
      (Matrix3d() << 0.070176418549, 0.014160349228, 0.000251125465, 0.014160349228, 0.034649982746,
       -0.006201235488, 0.000251125465, -0.006201235488, 0.109567059527)
          .finished();
  EXPECT_LT((centred.second_moment - second).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(centred.mean.norm(), 1e-300);
  const Matrix3d rotation =
      (Matrix3d() << 0.788318862359, 0.0203076516435, 0.000484461150438, 0.0203076516435,
       0.737307502675, -0.00845821179524, 0.000484461150438, -0.00845821179524, 0.839774966519)
          .finished();
  EXPECT_LT((centred.rotation - rotation).cwiseAbs().maxCoeff(), 1e-12);

  const ProjectedMoments off = projected_moments({0.1, -0.2, 0.05}, skewed());
  EXPECT_LT((off.mean - Vector3d(0.08729255, -0.18189944, 0.03119763)).norm(), 1e-8);
  const Vector3d variance = (off.second_moment - off.mean * off.mean.transpose()).diagonal();
  EXPECT_LT((variance - Vector3d(0.070701862802, 0.034919441497, 0.110682375314)).norm(), 1e-12);
}

// Oracle: numpy prototype by Monte Carlo; rotation standard deviation in degrees, C, and the
// variance of u under the distribution over that of the Gaussian.
TEST(ProjectedMoments, OfIsotropicSpreads) {
  const double table[][3] = {{5.0, 0.9888048, 0.9926},
                             {10.0, 0.9567146, 0.9714},
                             {15.0, 0.9086241, 0.9402},
                             {22.9, 0.8131702, 0.8794},
                             {57.3, 0.4273846, 0.629}};
  for (const auto& [degrees_of_rotation, c, ratio] : table) {
    const double u = 0.5 * radians(degrees_of_rotation);
    const Matrix3d covariance = u * u * Matrix3d::Identity();
    const ProjectedMoments moments = projected_moments(Vector3d::Zero(), covariance);
    EXPECT_NEAR(std::exp(moments.log_normalizer), c, 3e-4);
    EXPECT_NEAR(moments.second_moment(1, 1) / (u * u), ratio, 3e-4);
  }
}

TEST(ProjectedMoments, AreDerivativesOfTheNormalizer) {
  // In natural parameters J = S^-1, h = J m: d(ln C - ...)/dh = E[u]; here by m alone,
  // d ln C / dm = S^-1 (E[u] - m).
  const Vector3d mean(0.4, 0.3, -0.6);
  const Matrix3d covariance = 3.0 * skewed();
  const ProjectedMoments moments = projected_moments(mean, covariance);
  const Vector3d expected = covariance.inverse() * (moments.mean - mean);
  for (int i = 0; i < 3; ++i) {
    const double h = 1e-5;
    const Vector3d step = h * Vector3d::Unit(i);
    const double slope = (projected_log_normalizer(mean + step, covariance) -
                          projected_log_normalizer(mean - step, covariance)) /
                         (2.0 * h);
    EXPECT_NEAR(slope, expected[i], 1e-8);
  }
}

TEST(ProjectedCovariance, IsThatOfTheMoment) {
  for (const double scale : {1e-6, 0.01, 0.5, 4.0, 40.0}) {
    const Matrix3d covariance = scale * skewed();
    const Matrix3d moment = projected_moments(Vector3d::Zero(), covariance).second_moment;
    const ProjectedCovariance found = projected_covariance_of_moment(moment);
    EXPECT_TRUE(found.converged) << scale;
    EXPECT_LT((found.covariance - covariance).norm() / covariance.norm(), 1e-9) << scale;
  }
  const ProjectedCovariance flat =
      projected_covariance_of_moment(1e6 * Matrix3d::Identity(), 100.0);
  EXPECT_FALSE(flat.converged);
  EXPECT_NEAR(flat.covariance.trace(), 300.0, 1e-6);
}

}  // namespace
}  // namespace posemix
