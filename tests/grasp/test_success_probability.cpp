// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "density/projected_oracle.hpp"
#include "posemix/base/units.hpp"
#include "posemix/grasp/success_probability.hpp"

namespace posemix {
namespace {

using Eigen::Vector3d;
using Pose = ProjectedGaussian<SE3d>;

using oracle::covariance;

template <class D>
Mixture<D> single(const D& density) {
  const double weights[] = {1.0};
  return Mixture<D>::from_weights(weights, {density});
}

ToleranceBox box(double degrees_of_rotation, double metres) {
  return {Vector3d::Constant(radians(degrees_of_rotation)), Vector3d::Constant(metres)};
}

TEST(SuccessProbability, AgreesWithTheOracle) {
  // Oracle: numpy prototype by importance sampling with 2^20 Sobol points; |u_i| <= tan 4 deg.
  const auto mixture = single(Pose(SE3d(), covariance(1, 0.1, 0.02)));
  RandomStream stream(1);
  const auto success =
      success_probability(mixture, box(8.0, 0.03), SE3d(), stream, {.points = 1 << 14});
  EXPECT_NEAR(success.probability, 0.0392853403, 1e-6);
  EXPECT_LT(success.error, 5e-7);
}

TEST(SuccessProbability, IsAProductForIndependentCoordinates) {
  Vector6d spread;
  spread << 0.01, 0.02, 0.015, 0.004, 0.006, 0.002;
  const auto mixture =
      single(ConcentratedGaussian<SE3d>(SE3d(), Matrix6d(spread.cwiseAbs2().asDiagonal())));
  const ToleranceBox tolerance = box(2.0, 0.005);
  double product = 1.0;  // small angles: u = phi / 2
  for (int i = 0; i < 6; ++i) {
    const double limit = i < 3 ? tolerance.rotation[i] : tolerance.translation[i - 3];
    product *= std::erf(limit / spread[i] / std::numbers::sqrt2);
  }
  RandomStream stream(2);
  const auto success = success_probability(mixture, tolerance, SE3d(), stream);
  EXPECT_NEAR(success.probability, product, 2e-4);
}

Mixture<Pose> two_peaks() {
  const double weights[] = {0.7, 0.3};
  const SE3d here(SO3d::exp({0.2, -0.4, 1.0}), {0.1, 0.2, 0.6});
  const SE3d turned(here.rotation() * SO3d::exp({0.0, 0.0, 3.0}), {0.11, 0.2, 0.6});
  return Mixture<Pose>::from_weights(
      weights, {Pose(here, covariance(1, 0.03, 0.003)), Pose(turned, covariance(2, 0.05, 0.004))});
}

double sampled(const Mixture<Pose>& mixture, const ToleranceBox& tolerance, const SE3d& m,
               int samples) {
  RandomStream stream(3);
  int inside = 0;
  for (int i = 0; i < samples; ++i) {
    const SE3d x = m.inverse() * mixture.sample(stream);
    const Vector3d u = gnomonic::lift(SO3d(), x.rotation());
    const Vector3d limit = (0.5 * tolerance.rotation).array().tan();
    inside += ((u.cwiseAbs() - limit).maxCoeff() <= 0.0 &&
               (x.translation().cwiseAbs() - tolerance.translation).maxCoeff() <= 0.0)
                  ? 1
                  : 0;
  }
  return static_cast<double>(inside) / samples;
}

TEST(SuccessProbability, AgreesWithSamplesAnywhere) {
  const auto mixture = two_peaks();
  const SE3d shift = SE3d::exp((Vector6d() << 0.05, -0.03, 0.08, 0.004, 0.0, -0.003).finished());
  for (const SE3d& m :
       {mixture[0].density.mean(), mixture[1].density.mean(), mixture[0].density.mean() * shift}) {
    RandomStream stream(4);
    const auto success = success_probability(mixture, box(12.0, 0.01), m, stream);
    const double expected = sampled(mixture, box(12.0, 0.01), m, 100000);
    EXPECT_NEAR(success.probability, expected, 4.5 * std::sqrt(expected / 100000.0));
    EXPECT_LT(success.error, 2e-3 * success.probability);
  }
}

TEST(SuccessProbability, OfConcentratedGaussians) {
  const double weights[] = {1.0};
  const ConcentratedGaussian<SE3d> density(two_peaks()[0].density.mean(),
                                           covariance(2, 0.12, 0.008));
  const auto mixture = Mixture<ConcentratedGaussian<SE3d>>::from_weights(weights, {density});
  RandomStream stream(5), draws(6);
  const ToleranceBox tolerance = box(25.0, 0.02);
  const auto success = success_probability(mixture, tolerance, density.mean(), stream);
  int inside = 0;
  const int samples = 100000;
  const double limit = std::tan(0.5 * tolerance.rotation[0]);
  for (int i = 0; i < samples; ++i) {
    const SE3d x = density.mean().inverse() * density.sample(draws);
    const bool in = gnomonic::lift(SO3d(), x.rotation()).cwiseAbs().maxCoeff() <= limit &&
                    x.translation().cwiseAbs().maxCoeff() <= 0.02;
    inside += in ? 1 : 0;
  }
  const double expected = static_cast<double>(inside) / samples;
  EXPECT_GT(expected, 0.02);
  EXPECT_NEAR(success.probability, expected, 4.5 * std::sqrt(expected / samples));
}

TEST(SuccessProbability, ErrorIsThatOfTheReplicates) {
  const auto mixture = two_peaks();
  const SE3d m = mixture[0].density.mean();
  RandomStream reference(7);
  const double exact =
      success_probability(mixture, box(6.0, 0.006), m, reference, {.points = 1 << 13}).probability;
  double squares = 0.0;
  const int runs = 40;
  for (int i = 0; i < runs; ++i) {
    RandomStream stream(8, static_cast<std::uint64_t>(i));
    const auto success = success_probability(mixture, box(6.0, 0.006), m, stream, {.points = 64});
    squares += std::pow((success.probability - exact) / success.error, 2) / runs;
  }
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 3.0);
}

TEST(BestGrasp, BeatsTheModes) {
  const auto mixture = two_peaks();
  RandomStream stream(9);
  const auto best = best_grasp(mixture, box(6.0, 0.006), stream);
  ASSERT_EQ(best.candidates.size(), 2u);
  EXPECT_GE(best.candidates[0].success.probability, best.candidates[1].success.probability);
  for (const auto& candidate : best.candidates) {
    RandomStream at_start(10);
    const auto before = success_probability(mixture, box(6.0, 0.006), candidate.start, at_start);
    EXPECT_GE(candidate.success.probability, before.probability - 4.0 * before.error);
  }
  EXPECT_GT(best.evaluations, 2);
}

TEST(BestGrasp, FindsTheCentreFromTheSide) {
  // Two equal peaks close together: the best box lies between their modes.
  const double weights[] = {0.5, 0.5};
  const SE3d left(SO3d(), {-0.004, 0.0, 0.5}), right(SO3d(), {0.004, 0.0, 0.5});
  const Matrix6d spread = 1e-6 * Matrix6d::Identity();
  const auto mixture =
      Mixture<Pose>::from_weights(weights, {Pose(left, 4.0 * spread), Pose(right, 4.0 * spread)});
  RandomStream stream(11);
  const auto best = best_grasp(mixture, box(5.0, 0.007), stream);
  EXPECT_NEAR(best.pose.translation().x(), 0.0, 0.001);
  EXPECT_GT(best.success.probability, 0.85);
}

TEST(SuccessProbability, RefusesWhatIsNoBox) {
  const auto mixture = two_peaks();
  RandomStream stream(12);
  EXPECT_THROW(success_probability(mixture, box(0.0, 0.1), SE3d(), stream), InvalidInput);
  EXPECT_THROW(success_probability(mixture, box(180.1, 0.1), SE3d(), stream), InvalidInput);
  EXPECT_THROW(success_probability(mixture, box(5.0, -1.0), SE3d(), stream), InvalidInput);
  EXPECT_THROW(success_probability(mixture, box(5.0, NAN), SE3d(), stream), InvalidInput);
  EXPECT_THROW(success_probability(mixture, box(5.0, 0.1), SE3d(), stream, {.replicates = 1}),
               InvalidInput);
  EXPECT_THROW(best_grasp(mixture, box(5.0, 0.1), stream, {.starts = 0}), InvalidInput);
}

}  // namespace
}  // namespace posemix
