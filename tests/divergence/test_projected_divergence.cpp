// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/projected.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "small_mixtures.hpp"

namespace posemix {
namespace {

using testing::correlated;
using testing::single;
using Pose = ProjectedGaussian<SE3d>;
using Rotation = ProjectedGaussian<SO3d>;
using Vectors6 = ConcentratedGaussian<Rnd<6>>;

constexpr double kDegree = std::numbers::pi / 180.0;

Pose pose(RandomStream& stream, const SO3d& tangent_point, double deviation) {
  Vector6d mean;
  for (double& value : mean) value = deviation * stream.normal();
  return {tangent_point, mean, correlated(stream, 6, deviation)};
}

Rotation rotation(const SO3d& tangent_point, const Eigen::Vector3d& mean,
                  const Eigen::Vector3d& deviations) {
  return {tangent_point, mean, Eigen::Matrix3d(deviations.cwiseAbs2().asDiagonal())};
}

/// The Gaussian in the tangent space as a density on R^6.
Vectors6 in_vectors(const Pose& density) {
  return {Rnd<6>(density.tangent_mean()), density.covariance()};
}

void expect_near(const DivergenceEstimate& estimate, double exact, double relative_error) {
  EXPECT_NEAR(estimate.value, exact, 5.0 * estimate.error);
  EXPECT_LT(estimate.error, relative_error * std::abs(exact));
}

TEST(ProjectedDivergence, WithOneTangentPointTheGaussiansAreThoseOnVectors) {
  RandomStream stream(1);
  const SO3d q = SO3d::exp({0.4, -0.2, 0.9});
  const Pose a = pose(stream, q, 0.3);
  const Pose b = pose(stream, q, 0.4);
  EXPECT_NEAR(gaussian_kl(a, b), gaussian_kl(in_vectors(a), in_vectors(b)), 1e-12);
  // Eq. 23 as printed, n = 6.
  const Matrix6d inverse_a = a.covariance().inverse();
  const Matrix6d inverse_b = b.covariance().inverse();
  const Vector6d d = a.tangent_mean() - b.tangent_mean();
  const double printed = 0.5 * (inverse_b * a.covariance() + inverse_a * b.covariance() +
                                (inverse_a + inverse_b) * d * d.transpose())
                                   .trace() -
                         6.0;
  EXPECT_NEAR(gaussian_symmetric_kl(a, b), printed, 1e-11);
  EXPECT_NEAR(
      runnalls_bound<SE3d>({std::log(0.2), a}, {std::log(0.3), b}),
      runnalls_bound<Rnd<6>>({std::log(0.2), in_vectors(a)}, {std::log(0.3), in_vectors(b)}),
      1e-12);
  EXPECT_NEAR(mahalanobis_distance(a, b),
              std::sqrt(d.dot((a.covariance() + b.covariance()).inverse() * d)), 1e-12);
}

TEST(ProjectedDivergence, OfDistributionsIsWhatSamplingFinds) {
  RandomStream stream(2);
  for (const double deviation : {0.05, 0.3}) {
    const SO3d q = SO3d::exp({0.4, -0.2, 0.9});
    const Pose a = pose(stream, q, deviation);
    const Pose b = pose(stream, q, deviation);
    expect_near(kl_monte_carlo(single(a), single(b), stream), exact_kl(a, b), 0.01);
    expect_near(symmetric_kl_monte_carlo(single(a), single(b), stream), exact_symmetric_kl(a, b),
                0.05);
  }
}

TEST(ProjectedDivergence, OfLawsIsThatOfTheGaussiansWhereBothAreNarrow) {
  const Eigen::Vector3d shape_a(1.0, 0.7, 0.4);
  const Eigen::Vector3d shape_b(0.5, 0.9, 0.6);
  const Eigen::Vector3d apart(0.3, -0.5, 0.2);
  double before = std::numeric_limits<double>::infinity();
  for (const double degrees : {0.1, 5.0, 15.0, 30.0}) {
    // Standard deviations of u are half those of the angle. Eq. 23 does not depend on the scale.
    const double scale = 0.5 * degrees * kDegree;
    const Rotation a = rotation(SO3d(), Eigen::Vector3d::Zero(), scale * shape_a);
    const Rotation b = rotation(SO3d(), scale * apart, scale * shape_b);
    const double gaussian = gaussian_symmetric_kl(a, b);
    const double distribution = exact_symmetric_kl(a, b);
    EXPECT_LT(distribution, before);
    EXPECT_LT(distribution, gaussian);
    if (degrees == 0.1) {
      EXPECT_NEAR(distribution, gaussian, 1e-4 * gaussian);
    }
    before = distribution;
  }
}

TEST(ProjectedDivergence, DoesNotDependOnTheFrame) {
  RandomStream stream(3);
  const SO3d turn = SO3d::exp({1.0, 0.3, -0.4});
  const Rotation a = rotation(SO3d::exp({0.1, 0.0, 0.2}), {0.1, 0.05, 0.0}, {0.1, 0.2, 0.3});
  const Rotation b = rotation(SO3d::exp({0.3, -0.2, 0.1}), {0.0, 0.1, 0.0}, {0.2, 0.1, 0.2});
  const auto turned = [&](const Rotation& p) {
    return Rotation(turn * p.tangent_point(), p.tangent_mean(), p.covariance());
  };
  EXPECT_NEAR(exact_kl(turned(a), turned(b)), exact_kl(a, b), 1e-12);
  EXPECT_NEAR(gaussian_kl(turned(a), turned(b)), gaussian_kl(a, b), 1e-12);
  EXPECT_NEAR(exact_symmetric_kl(a, b), exact_symmetric_kl(b, a), 1e-12);
  EXPECT_NEAR(exact_kl(a, a), 0.0, 1e-14);
  // In charts at their own modes they are nearly the same densities.
  EXPECT_NEAR(exact_kl(change_chart_to_mode(a), change_chart_to_mode(b)), exact_kl(a, b), 0.02);
}

/// int f(angle) times the Haar measure of all rotations by that angle, 16 pi sin(angle / 2)^2.
template <class Function>
double over_angles(double largest, Function&& f) {
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = largest * (i + 0.5) / kSteps;
    const double sine = std::sin(0.5 * angle);
    sum += f(angle) * 16.0 * std::numbers::pi * sine * sine;
  }
  return sum * largest / kSteps;
}

TEST(MonteCarloOfTwoKinds, IsTheIntegralOverTheAngle) {
  const ConcentratedGaussian<SO3d> lie(SO3d(), 0.09 * Eigen::Matrix3d::Identity());
  const Rotation projected(SO3d(), Eigen::Matrix3d(0.04 * Eigen::Matrix3d::Identity()));
  const auto log_lie = [&](double a) { return lie.log_density(SO3d::exp({a, 0, 0})); };
  const auto log_projected = [&](double a) { return projected.log_density(SO3d::exp({0, a, 0})); };
  const double most = 2.5;  // eight standard deviations of the wider density
  const auto kl_of = [&](const auto& log_p, const auto& log_q) {
    return over_angles(most, [&](double a) { return std::exp(log_p(a)) * (log_p(a) - log_q(a)); });
  };
  const double forward = kl_of(log_lie, log_projected);
  const double backward = kl_of(log_projected, log_lie);
  const double square = over_angles(most, [&](double a) {
    return std::pow(std::exp(log_lie(a)) - std::exp(log_projected(a)), 2);
  });
  RandomStream stream(4);
  expect_near(kl_monte_carlo(single(lie), single(projected), stream), forward, 0.01);
  expect_near(kl_monte_carlo(single(projected), single(lie), stream), backward, 0.01);
  expect_near(symmetric_kl_monte_carlo(single(lie), single(projected), stream), forward + backward,
              0.01);
  expect_near(isd_monte_carlo(single(projected), single(lie), stream), square, 0.01);
}

TEST(MonteCarloOfTwoKinds, TheStreamDeterminesTheResult) {
  const Rotation p = rotation(SO3d(), {0.1, 0.0, 0.0}, {0.1, 0.2, 0.3});
  const Rotation q = rotation(SO3d(), {0.0, 0.1, 0.0}, {0.1, 0.2, 0.3});
  const auto estimate = [&](std::uint64_t seed) {
    RandomStream stream(seed);
    return kl_monte_carlo(single(p), single(q), stream, {.samples = 2048, .replicates = 4}).value;
  };
  EXPECT_EQ(estimate(1), estimate(1));
  EXPECT_NE(estimate(1), estimate(2));
  RandomStream stream(1);
  EXPECT_THROW(kl_monte_carlo(single(p), single(q), stream, {.samples = 8, .replicates = 1}),
               InvalidInput);
}

}  // namespace
}  // namespace posemix
