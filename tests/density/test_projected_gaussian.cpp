// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/testing/statistics.hpp"
#include "projected_oracle.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Rotation = ProjectedGaussian<SO3d>;
using Pose = ProjectedGaussian<SE3d>;

Matrix3d tilted() {
  return (Matrix3d() << 0.09, 0.02, 0.0, 0.02, 0.04, -0.01, 0.0, -0.01, 0.16).finished();
}

Pose example() {
  return oracle::gaussian({1.0, -2.0, 0.5}, {0.3, -0.2, 0.4}, oracle::first_covariance());
}

// Oracle: numpy prototype.
TEST(ChartChange, AgreesWithTheOracle) {
  const gnomonic::ChartChange f(SO3d::exp({0.3, -0.2, 0.5}), SO3d::exp({0.1, 0.1, 0.2}));
  const Vector3d u(0.1, -0.05, 0.2);
  const Vector3d expected(0.16504466870135037, -0.21131145983037594, 0.39649747373095745);
  EXPECT_LT((f(u) - expected).norm(), 1e-15);
  EXPECT_NEAR(f.jacobian(u).determinant(), 1.3637413560642841, 1e-14);
  EXPECT_NEAR(std::exp(f.log_det_jacobian(u)), 1.3637413560642841, 1e-14);
}

TEST(ChartChange, HasTheDerivativesOfItsValues) {
  const gnomonic::ChartChange f(SO3d::exp({0.3, -0.2, 0.5}), SO3d::exp({-1.0, 0.4, 0.9}));
  const Vector3d u(0.1, -0.4, 0.2), g(0.7, -0.3, 1.1);
  const double h = 1e-5;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = h * Vector3d::Unit(i);
    const Vector3d column = (f(u + step) - f(u - step)) / (2.0 * h);
    EXPECT_LT((f.jacobian(u).col(i) - column).norm(), 1e-9);
    const Vector3d of_gradient =
        (f.jacobian(u + step) - f.jacobian(u - step)).transpose() * g / (2.0 * h);
    EXPECT_LT((f.second_derivative(u, g).col(i) - of_gradient).norm(), 1e-8);
  }
}

TEST(ProjectedGaussian, IsTheSameForBothQuaternions) {
  const Pose density = example();
  const Eigen::Quaterniond& q = density.tangent_point().quaternion();
  const SO3d minus = SO3d::from_quaternion(Eigen::Quaterniond(-q.coeffs()));
  const Pose same(SE3d(minus, density.mean().translation()), density.covariance());
  RandomStream stream(1);
  for (int i = 0; i < 100; ++i) {
    const SE3d at = density.sample(stream);
    const SO3d turned =
        SO3d::from_quaternion(Eigen::Quaterniond(-at.rotation().quaternion().coeffs()));
    EXPECT_NEAR(density.log_density(at), density.log_density(SE3d(turned, at.translation())),
                1e-11);
    EXPECT_NEAR(density.log_density(at), same.log_density(at), 1e-12);
  }
}

TEST(ProjectedGaussian, VanishesOnTheEquator) {
  const Rotation density(SO3d(), tilted());
  const auto half_turn = SO3d::from_quaternion(Eigen::Quaterniond(0.0, 0.6, 0.0, 0.8));
  EXPECT_EQ(density.log_density(half_turn), -std::numeric_limits<double>::infinity());
  EXPECT_LT(density.log_density(SO3d::exp({std::numbers::pi - 1e-6, 0.0, 0.0})), -1e9);
}

TEST(ProjectedGaussian, ModeIsAtTheTangentMean) {
  const Rotation density(SO3d::exp({0.5, 0.1, 0.0}), Vector3d(0.3, -0.2, 0.6), tilted());
  const double peak = density.log_density(density.mean());
  EXPECT_NEAR(peak,
              -0.5 * (std::log(tilted().determinant()) + 3.0 * kLogTwoPi) -
                  density.log_normalizer() - gnomonic::kLogHaarPerHalfSphere,
              1e-12);
  for (int i = 0; i < 3; ++i) {
    for (const double step : {0.01, -0.01}) {
      EXPECT_LT(density.log_density(density.mean() * SO3d::exp(step * Vector3d::Unit(i))), peak);
    }
  }
}

/// Integral of a density over the rotations by the midpoint rule on unit quaternions (Hopf
/// coordinates), independent of every chart.
double integral(const Rotation& density) {
  const Rotation::Evaluator evaluator(density);
  const int n = 96;
  const double pi = std::numbers::pi;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double s = (i + 0.5) / n;  // |(q_w, q_z)|^2, uniform in [0, 1]
    for (int j = 0; j < n; ++j) {
      const double a = pi * (j + 0.5) / n;  // half a turn: q and -q
      for (int k = 0; k < 2 * n; ++k) {
        const double b = pi * (k + 0.5) / n;
        const double outer = std::sqrt(s), inner = std::sqrt(1.0 - s);
        const Eigen::Quaterniond q(outer * std::cos(a), inner * std::cos(b), inner * std::sin(b),
                                   outer * std::sin(a));
        sum += std::exp(evaluator.log_density(SO3d::from_quaternion(q)));
      }
    }
  }
  return sum * 8.0 * pi * pi / (2.0 * n * n * n);
}

TEST(ProjectedGaussian, IntegratesToOne) {
  EXPECT_NEAR(integral(Rotation(SO3d::exp({0.4, 2.0, -1.0}), tilted())), 1.0, 2e-5);
  EXPECT_NEAR(integral(Rotation(SO3d(), Vector3d(0.5, 0.0, -1.0), 4.0 * tilted())), 1.0, 1e-4);
  EXPECT_NEAR(integral(Rotation(SO3d(), 30.0 * Matrix3d::Identity())), 1.0, 1e-4);
}

TEST(ProjectedGaussian, SamplesHaveTheMomentsOfTheDistribution) {
  const Rotation wide(SO3d::exp({0.4, 2.0, -1.0}), Vector3d(0.1, -0.2, 0.05), 6.0 * tilted());
  for (const Rotation& density : {Rotation(SO3d(), tilted()), wide}) {
    RandomStream stream(2);
    testing::SampleMoments rotations(9);
    const DistributionMoments<SO3d> distribution = moments_of(density);
    for (int i = 0; i < 40000; ++i) {
      rotations.add(density.sample(stream).matrix().reshaped());
    }
    const Eigen::VectorXd spread = rotations.covariance().diagonal().cwiseSqrt() / 200.0;
    const Eigen::VectorXd difference = rotations.mean() - distribution.rotation.reshaped();
    EXPECT_LT((difference.array() / spread.array()).abs().maxCoeff(), 4.5);
  }
  const Pose pose = example();
  const DistributionMoments<SE3d> distribution = moments_of(pose);
  RandomStream stream(3);
  testing::SampleMoments coordinates(6);
  for (int i = 0; i < 40000; ++i) coordinates.add(pose.coordinates(pose.sample(stream)));
  EXPECT_LT(coordinates.worst_score(distribution.mean, distribution.covariance), 4.5);
}

// Oracle: numpy prototype. Rotation standard deviation in degrees, then KL of projected Gaussian
// samples from the density of eq. 11.
TEST(ProjectedGaussian, ProjectedSamplesHaveAnotherDistribution) {
  const double table[][2] = {{15.0, 2.9e-3}, {22.9, 1.3e-2}, {57.3, 0.167}};
  for (const auto& [degrees_of_rotation, expected] : table) {
    const double u = 0.5 * radians(degrees_of_rotation);
    const Rotation density(SO3d(), Matrix3d(u * u * Matrix3d::Identity()));
    RandomStream stream(4);
    double sum = 0.0;
    const int samples = 200000;
    for (int i = 0; i < samples; ++i) {
      // The distribution of a projected sample has density N(u) (1 + u.u)^2 in dm, eq. 11 N(u) / C.
      const Vector3d at = density.coordinates(density.sample_by_projection(stream));
      sum += 2.0 * std::log1p(at.squaredNorm());
    }
    EXPECT_NEAR(sum / samples + density.log_normalizer(), expected, 4e-4 + 0.05 * expected);
  }
}

TEST(ProjectedGaussian, DistributionMomentsAndBack) {
  const Pose density = example();
  const DistributionMoments<SE3d> distribution = moments_of(density);
  const Pose again =
      with_moments<SE3d>(density.tangent_point(), distribution.mean, distribution.covariance);
  EXPECT_LT((again.covariance() - density.covariance()).norm(), 1e-12);
  EXPECT_LT((again.tangent_mean() - density.tangent_mean()).norm(), 1e-12);
}

TEST(ProjectedGaussian, ChangesTheChartWithItsJacobian) {
  const Pose density = example();
  const SO3d near = density.tangent_point() * SO3d::exp({0.1, 0.2, -0.1});
  const Pose moved = change_chart(density, near);
  EXPECT_TRUE(moved.mean().is_approx(density.mean(), 1e-13));
  const Pose back = change_chart(moved, density.tangent_point());
  EXPECT_LT((back.covariance() - density.covariance()).norm(), 1e-13);
  EXPECT_LT(change_chart_to_mode(moved).tangent_mean().head<3>().norm(), 1e-14);
  const auto opposite =
      density.tangent_point() * SO3d::from_quaternion(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0));
  EXPECT_THROW(change_chart(density, opposite), InvalidInput);
}

TEST(ProjectedParts, ConditionalTimesMarginalIsTheJoint) {
  const Pose joint = example();
  RandomStream stream(5);
  for (int i = 0; i < 20; ++i) {
    const SE3d at = joint.sample(stream);
    const TranslationMoments t = translation_given_rotation(joint, at.rotation());
    const double conditional =
        log_normal(Eigen::LLT<Matrix3d>(t.covariance), Vector3d(at.translation() - t.mean));
    EXPECT_NEAR(rotation_marginal(joint).log_density(at.rotation()) + conditional,
                joint.log_density(at), 1e-10);
  }
  // The rotation given the translation is the joint density up to a constant.
  const Vector3d translation = joint.mean().translation() + Vector3d(0.02, -0.01, 0.0);
  const Rotation given = rotation_given_translation(joint, translation);
  const SO3d a = joint.sample(stream).rotation(), b = joint.sample(stream).rotation();
  EXPECT_NEAR(given.log_density(a) - given.log_density(b),
              joint.log_density(SE3d(a, translation)) - joint.log_density(SE3d(b, translation)),
              1e-10);
}

TEST(ProjectedParts, TranslationMarginalIsThatOfTheSamples) {
  const Pose joint(SO3d(), (Vector6d() << 0.3, 0.2, -0.1, 1.0, 2.0, 3.0).finished(),
                   4.0 * oracle::first_covariance());
  const TranslationMoments t = translation_marginal(joint);
  RandomStream stream(6);
  testing::SampleMoments moments(3);
  for (int i = 0; i < 40000; ++i) moments.add(joint.sample(stream).translation());
  EXPECT_LT(moments.worst_score(t.mean, t.covariance), 4.5);
}

TEST(ProjectedSplit, SumsToTheDensity) {
  const Matrix6d covariance = 3.0 * oracle::first_covariance();
  const Pose density(example().mean(), covariance);
  const auto pieces = split(density, 0.15);
  double total = 0.0;
  for (const auto& piece : pieces) {
    total += piece.weight;
    EXPECT_LT(piece.density.tangent_mean().head<3>().norm(), 1e-14);
  }
  EXPECT_NEAR(total, 1.0, 1e-12);
  RandomStream stream(8);
  double divergence = 0.0;
  const int samples = 4000;
  for (int i = 0; i < samples; ++i) {
    const SE3d at = density.sample(stream);
    double sum = 0.0;
    for (const auto& piece : pieces) sum += piece.weight * std::exp(piece.density.log_density(at));
    divergence += (density.log_density(at) - std::log(sum)) / samples;
  }
  EXPECT_LT(divergence, 0.05);
  EXPECT_GT(divergence, -0.02);
  EXPECT_EQ(split(density, 10.0).size(), 1u);
  EXPECT_THROW(split(density, 0.0), InvalidInput);
  EXPECT_THROW(split(density, 0.005), InvalidInput);
}

TEST(ProjectedGaussian, RefusesWhatIsNoCovariance) {
  Matrix3d bad = tilted();
  bad(0, 0) = -1.0;
  EXPECT_THROW(Rotation(SO3d(), bad), InvalidInput);
  bad(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Rotation(SO3d(), bad), InvalidInput);
  EXPECT_THROW(Rotation(SO3d(), Vector3d(0.0, 0.0, NAN), tilted()), InvalidInput);
  EXPECT_THROW(Rotation(SO3d::exp({0.0, NAN, 0.0}), tilted()), InvalidInput);
}

}  // namespace
}  // namespace posemix
