// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/conversion.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "posemix/density/projected_operations.hpp"
#include "posemix/testing/expect.hpp"
#include "small_mixtures.hpp"

namespace posemix {
namespace {

using testing::single;
using Lie = ConcentratedGaussian<SE3d>;
using Projected = ProjectedGaussian<SE3d>;

constexpr double kOneDegree = std::numbers::pi / 180.0;
constexpr std::array kRules{ConversionRule::linear, ConversionRule::cubature,
                            ConversionRule::maximum_likelihood};

/// A correlated covariance; the mean variance of the first three coordinates is `rotation` squared.
Matrix6d covariance(int seed, double rotation, double translation) {
  Matrix6d a;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) a(i, j) = ((7 * i + 3 * j + 5 * seed) % 11 - 5) / 10.0;
  }
  const Matrix6d shape = a * a.transpose() + Matrix6d::Identity();
  const double unit = std::sqrt(shape.topLeftCorner<3, 3>().trace() / 3.0);
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(rotation / unit), Eigen::Vector3d::Constant(translation);
  Matrix6d result = scale.asDiagonal() * shape * scale.asDiagonal();
  symmetrize(result);
  return result;
}

const SE3d kMean(SO3d::exp({0.2, -0.1, 0.3}), {0.3, -0.2, 0.5});

Lie lie(int seed, double degrees) {
  Matrix6d p = kMean.adjoint_congruence(covariance(seed, degrees * kOneDegree, 0.03));
  symmetrize(p);
  return {kMean, p};
}
Projected projected(int seed, double degrees) {
  return {kMean, covariance(seed, 0.5 * degrees * kOneDegree, 0.03)};
}

/// Every rule uses the same points, so that differences are not noise.
template <class P, class Q>
double lost(const P& before, const Q& after) {
  RandomStream stream(1);
  return kl_monte_carlo(single(before), single(after), stream,
                        {.samples = 1 << 14, .replicates = 8})
      .value;
}

/// Losses for the two covariances here. A study with a covariance of its own has, from concentrated
/// to projected, linear / cubature / maximum likelihood: 5 deg .0013 .0012 .0006, 15 deg .024 .0136
/// .0106, 30 deg .29 .119 .077; and back, 15 deg .029 .0157 .0131, 30 deg .146 .059 .044.
struct Band {
  double degrees;
  double linear;
  double most_likely;
};

void expect_band(const std::array<double, 3>& kl, const Band& band) {
  EXPECT_NEAR(kl[0], band.linear, 0.15 * band.linear) << band.degrees;
  EXPECT_NEAR(kl[2], band.most_likely, 0.15 * band.most_likely) << band.degrees;
  EXPECT_LT(kl[1], kl[0]);
  EXPECT_LT(kl[2], kl[1] * 1.001 + 1e-6);
}

TEST(Conversion, MaximumLikelihoodLosesTheLeast) {
  for (const Band& band :
       {Band{5.0, 0.0012, 0.0009}, Band{15.0, 0.0235, 0.0097}, Band{30.0, 0.28, 0.069}}) {
    for (const int seed : {1, 2}) {
      std::array<double, 3> kl{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Lie before = lie(seed, band.degrees);
        const auto after = to_projected(before, kRules[i]);
        EXPECT_TRUE(after.converged);
        kl[i] = lost(before, after.density);
      }
      expect_band(kl, band);
    }
  }
  for (const Band& band :
       {Band{5.0, 0.0014, 0.00095}, Band{15.0, 0.020, 0.0085}, Band{30.0, 0.123, 0.030}}) {
    for (const int seed : {1, 2}) {
      std::array<double, 3> kl{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Projected before = projected(seed, band.degrees);
        const auto after = to_concentrated(before, kRules[i]);
        EXPECT_TRUE(after.converged);
        kl[i] = lost(before, after.density);
      }
      expect_band(kl, band);
    }
  }
}

TEST(Conversion, NoNeighbourOfTheMostLikelyIsBetter) {
  const Lie before = lie(1, 15.0);
  const Projected after = to_projected(before).density;
  const double best = lost(before, after);
  RandomStream draw(2);
  for (int trial = 0; trial < 10; ++trial) {
    Vector6d move;
    for (double& value : move) value = 0.02 * draw.normal();
    Vector6d stretch;
    for (double& value : stretch) value = std::exp(0.05 * draw.normal());
    const Projected moved(
        SE3d(after.mean().rotation() * SO3d::exp(move.head<3>()),
             after.mean().translation() + 0.1 * move.tail<3>()),
        Matrix6d(stretch.asDiagonal() * after.covariance() * stretch.asDiagonal()));
    EXPECT_GT(lost(before, moved), best);
  }
}

TEST(Conversion, OfNarrowDensitiesIsLinear) {
  for (const ConversionRule rule : kRules) {
    const auto there = to_projected(lie(1, 0.05), rule).density;
    const auto back = to_concentrated(there, rule).density;
    EXPECT_LT(testing::relative_difference(
                  there.covariance(),
                  to_projected(lie(1, 0.05), ConversionRule::linear).density.covariance()),
              2e-3);
    EXPECT_LT(testing::relative_difference(back.covariance(), lie(1, 0.05).covariance()), 2e-3);
    EXPECT_TRUE(back.mean().is_approx(kMean, 1e-4));
  }
  // u = phi / 2, exactly, and t = t0 + R0 rho.
  const Projected linear = to_projected(lie(1, 10.0), ConversionRule::linear).density;
  const Matrix6d body = lie(1, 10.0).body_covariance();
  const Eigen::Matrix3d r = kMean.rotation().matrix();
  EXPECT_TRUE(testing::matrices_near(Eigen::Matrix3d(linear.covariance().topLeftCorner<3, 3>()),
                                     Eigen::Matrix3d(0.25 * body.topLeftCorner<3, 3>()), 1e-15));
  EXPECT_TRUE(testing::matrices_near(
      Eigen::Matrix3d(linear.covariance().bottomRightCorner<3, 3>()),
      Eigen::Matrix3d(r * body.bottomRightCorner<3, 3>() * r.transpose()), 1e-15));
  EXPECT_TRUE(testing::matrices_near(
      Eigen::Matrix3d(linear.covariance().topRightCorner<3, 3>()),
      Eigen::Matrix3d(0.5 * body.topRightCorner<3, 3>() * r.transpose()), 1e-15));
}

TEST(Conversion, OfIsotropicRotationsHasTheVarianceOfTheAngle) {
  // The best concentrated Gaussian has the variance E[angle^2] / 3 under the distribution of the
  // projected one, density N(u; 0, s^2) of u = tan(angle / 2) with respect to (1 + u^2)^-2 du.
  constexpr double s = 0.2;
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double u = 10.0 * s * (i + 0.5) / kSteps;
    const double weight = u * u * std::exp(-0.5 * u * u / (s * s)) * std::pow(1.0 + u * u, -2);
    sum += weight;
    squares += weight * std::pow(2.0 * std::atan(u), 2);
  }
  const ProjectedGaussian<SO3d> before(SO3d::exp({0.3, 0.1, 0.2}),
                                       Eigen::Matrix3d(s * s * Eigen::Matrix3d::Identity()));
  const auto after = to_concentrated(before);
  EXPECT_TRUE(after.converged);
  EXPECT_LT(testing::relative_difference(
                after.density.covariance(),
                Eigen::Matrix3d(squares / sum / 3.0 * Eigen::Matrix3d::Identity())),
            1e-6);
  EXPECT_TRUE(after.density.mean().is_approx(before.mean(), 1e-10));
}

TEST(Conversion, AnyTangentPointWillDo) {
  const Projected at_mode = projected(1, 8.0);
  const Projected elsewhere =
      change_chart(at_mode, at_mode.tangent_point() * SO3d::exp({0.05, -0.1, 0.02}));
  for (const ConversionRule rule : kRules) {
    const auto a = to_concentrated(at_mode, rule).density;
    const auto b = to_concentrated(elsewhere, rule).density;
    EXPECT_LT((a.mean().inverse() * b.mean()).log().norm(), 0.003);
    EXPECT_LT(testing::relative_difference(b.covariance(), a.covariance()), 0.03);
  }
}

TEST(Split, IsCloseToTheWholeAndNarrower) {
  const Lie whole = lie(1, 20.0);
  const auto pieces = split(whole, 0.2);
  EXPECT_GT(pieces.size(), 9U);
  double weight = 0.0;
  for (const auto& piece : pieces) {
    weight += std::exp(piece.log_weight);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
        Eigen::Matrix3d(piece.density.covariance().topLeftCorner<3, 3>()));
    EXPECT_LT(axes.eigenvalues()[2], 0.23 * 0.23);  // back-projection stretches a little
  }
  EXPECT_NEAR(weight, 1.0, 1e-12);
  RandomStream stream(3);
  EXPECT_LT(kl_monte_carlo(single(whole), Mixture<Lie>(pieces), stream,
                           {.samples = 4096, .replicates = 8})
                .value,
            0.02);
  EXPECT_EQ(split(whole, 3.0).size(), 1U);
  EXPECT_THROW(split(whole, 0.0), InvalidInput);
  EXPECT_THROW(split(whole, 0.01), InvalidInput);
}

Mixture<Lie> wide_and_narrow() {
  return Mixture<Lie>({{std::log(0.4), lie(1, 30.0)}, {std::log(0.6), lie(2, 6.0)}});
}

TEST(ConversionOfMixtures, SplitsWhatWouldLoseTooMuch) {
  RandomStream stream(4);
  const auto accepted =
      to_projected(wide_and_narrow(), stream, {.on_large_loss = LargeLoss::accept});
  EXPECT_EQ(accepted.mixture.size(), 2U);
  EXPECT_EQ(accepted.components_split, 0U);
  EXPECT_FALSE(accepted.within_limit);
  EXPECT_GT(accepted.largest_component_kl, 0.05);
  const auto split_up = to_projected(wide_and_narrow(), stream);
  EXPECT_GT(split_up.mixture.size(), 3U);
  EXPECT_EQ(split_up.components_split, 1U);
  EXPECT_TRUE(split_up.within_limit);
  EXPECT_TRUE(split_up.converged);
  EXPECT_LE(split_up.largest_component_kl, 0.05);
  EXPECT_LT(split_up.kl_lost, 0.5 * accepted.kl_lost);
  EXPECT_GT(split_up.kl_error, 0.0);
  // The weights of the components are kept.
  EXPECT_NEAR(split_up.mixture.weight(split_up.mixture.size() - 1), 0.6, 1e-12);
}

// So wide that a part of the probability is beyond half a turn, where the density ends: measured
// so, it gains, which is no conversion within a limit.
TEST(ConversionOfMixtures, ANegativeLossIsNotWithinTheLimit) {
  RandomStream stream(9);
  const Mixture<ConcentratedGaussian<SO3d>> wide(
      {{0.0, ConcentratedGaussian<SO3d>(SO3d(), 9.0 * Eigen::Matrix3d::Identity())}});
  const auto converted = to_projected(wide, stream);
  EXPECT_LT(converted.kl_lost, -0.05);
  EXPECT_LT(converted.largest_component_kl, -0.05);
  EXPECT_FALSE(converted.within_limit);
}

TEST(ConversionOfMixtures, LosesNoMoreThanItsComponentsDo) {
  RandomStream stream(5);
  const Mixture<Projected> mixture(
      {{std::log(0.4), projected(1, 20.0)}, {std::log(0.6), projected(2, 10.0)}});
  for (const ConversionRule rule : kRules) {
    const auto result =
        to_concentrated(mixture, stream, {.rule = rule, .on_large_loss = LargeLoss::accept});
    EXPECT_LE(result.kl_lost, result.largest_component_kl + 3.0 * result.kl_error);
    EXPECT_NEAR(result.mixture.weight(0), 0.4, 1e-12);
  }
}

TEST(ConversionOfMixtures, RefusesByNumber) {
  RandomStream stream(6);
  const ConversionSettings refusing{.on_large_loss = LargeLoss::refuse};
  const std::string message =
      testing::thrown_message([&] { to_projected(wide_and_narrow(), stream, refusing); });
  EXPECT_NE(message.find("component 0 would lose 0.0"), std::string::npos) << message;
  EXPECT_NE(message.find("max_kl = 0.05"), std::string::npos) << message;
  EXPECT_TRUE(to_projected(single(lie(2, 6.0)), stream, refusing).within_limit);
  EXPECT_THROW(to_projected(wide_and_narrow(), stream, {.max_kl = 0.0}), InvalidInput);
  EXPECT_THROW(to_projected(wide_and_narrow(), stream, {.max_pieces = 0}), InvalidInput);
}

// 1e100 half turns: the weights of all points were 0 / 0.
TEST(Conversion, OfADensityWithoutAPointWithinReachIsRefused) {
  Matrix6d wide = 1e-4 * Matrix6d::Identity();
  wide(0, 0) = 1e200;
  const std::string expected =
      "conversion: no point of the density is within 150 deg of its centre, expected a narrower "
      "one";
  EXPECT_EQ(testing::thrown_message([&] { to_projected(ConcentratedGaussian<SE3d>({}, wide)); }),
            expected);
  EXPECT_EQ(testing::thrown_message([&] { to_concentrated(ProjectedGaussian<SE3d>({}, wide)); }),
            expected);
}

}  // namespace
}  // namespace posemix
