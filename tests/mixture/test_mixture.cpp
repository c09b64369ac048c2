// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/mixture.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/mixture/moments.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::thrown_message;
using Line = ConcentratedGaussian<Rnd<1>>;
using LineMixture = Mixture<Line>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Line on_line(double mean, double variance) {
  return {Rnd<1>(Eigen::Matrix<double, 1, 1>(mean)), Eigen::Matrix<double, 1, 1>(variance)};
}

LineMixture with_log_weights(const std::vector<double>& log_weights) {
  std::vector<Component<Line>> components;
  for (const double log_weight : log_weights) components.push_back({log_weight, on_line(0.0, 1.0)});
  return LineMixture(std::move(components));
}

LineMixture with_weights(const std::vector<double>& weights) {
  return LineMixture::from_weights(weights, std::vector<Line>(weights.size(), on_line(0.0, 1.0)));
}

TEST(LogSumExp, AgreesWithTheDirectSumAndItsLimits) {
  EXPECT_NEAR(log_sum_exp(std::vector{0.0, std::log(2.0), std::log(5.0)}), std::log(8.0), 1e-15);
  EXPECT_NEAR(log_sum_exp(std::vector{-1000.0, -1000.0}), -1000.0 + std::log(2.0), 1e-12);
  EXPECT_NEAR(log_sum_exp(std::vector{1000.0, 998.0}), 1000.0 + std::log1p(std::exp(-2.0)), 1e-12);
  EXPECT_EQ(log_sum_exp(std::vector<double>{}), -kInfinity);
  EXPECT_EQ(log_sum_exp(std::vector{-kInfinity, -kInfinity}), -kInfinity);
  EXPECT_EQ(log_sum_exp(std::vector{-kInfinity, 3.0}), 3.0);
}

TEST(Mixture, NormalisesItsWeights) {
  const LineMixture mixture = with_weights({1.0, 0.0, 3.0});
  EXPECT_NEAR(mixture.weight(0), 0.25, 1e-15);
  EXPECT_EQ(mixture.weight(1), 0.0);
  EXPECT_NEAR(mixture.weight(2), 0.75, 1e-15);
  EXPECT_EQ(mixture.heaviest(), 2U);
}

TEST(Mixture, WeightsFarBelowUnderflowKeepTheirRatio) {
  // exp(-1000) is zero in double precision; only the difference of the logarithms counts.
  const LineMixture mixture = with_log_weights({-2000.0, -1000.0, -1001.0});
  EXPECT_NEAR(mixture[0].log_weight, -1000.0 - std::log1p(std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(mixture.weight(1), 1.0 / (1.0 + std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(mixture.weight(2), 1.0 / (1.0 + std::exp(1.0)), 1e-12);
}

TEST(Mixture, WeightsOfWhatIsHardlyPossibleSumToOne) {
  // The log of the sum, about -3e13, has two digits after the point; products of densities that are
  // kilometres apart, and known to micrometres, weigh so little.
  const LineMixture mixture = with_log_weights({-3e13, -3e13 - 1.0, -3e13 - 2.0, -3e13 - 1e6});
  const double sum = 1.0 + std::exp(-1.0) + std::exp(-2.0);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(mixture.weight(i), std::exp(-static_cast<double>(i)) / sum, 1e-15) << i;
  EXPECT_NEAR(mixture[3].log_weight, -1e6 - std::log(sum), 1e-9);
  const std::vector<Component<Line>> far{{-3e13, on_line(0.0, 1.0)},
                                         {-3e13 - 1.0, on_line(1.0, 1.0)}};
  const auto whole = moments(std::span(far));
  EXPECT_TRUE(whole.converged);
  EXPECT_NEAR(whole.density.mean().value()[0], 1.0 / (1.0 + std::exp(1.0)), 1e-15);
}

TEST(Mixture, StoredWeightsAreKeptBitByBit) {
  RandomStream stream(5);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> log_weights(7);
    for (double& log_weight : log_weights) log_weight = -20.0 * stream.uniform();
    const LineMixture mixture = with_log_weights(log_weights);
    const auto again = LineMixture::from_stored(mixture.components());
    for (std::size_t i = 0; i < mixture.size(); ++i) {
      EXPECT_EQ(again[i].log_weight, mixture[i].log_weight);
    }
  }
  const auto raw =
      LineMixture::from_stored({{std::log(2.0), on_line(0.0, 1.0)}, {0.0, on_line(1.0, 1.0)}});
  EXPECT_NEAR(raw.weight(0), 2.0 / 3.0, 1e-15);
}

TEST(Mixture, HeaviestIsTheFirstOfEquals) {
  EXPECT_EQ(with_weights({1.0, 2.0, 2.0}).heaviest(), 1U);
  EXPECT_EQ(with_weights({1.0}).heaviest(), 0U);
}

TEST(Mixture, RejectsUnusableWeights) {
  EXPECT_EQ(thrown_message([] { LineMixture(std::vector<Component<Line>>{}); }),
            "a mixture needs at least one component");
  EXPECT_EQ(thrown_message([] {
              with_log_weights({0.0, kNan});
            }),
            "log-weight 1 is nan, expected a number or -inf");
  EXPECT_EQ(thrown_message([] { with_log_weights({kInfinity}); }),
            "log-weight 0 is inf, expected a number or -inf");
  EXPECT_EQ(thrown_message([] {
              with_log_weights({-kInfinity, -kInfinity});
            }),
            "all weights are zero");
  EXPECT_EQ(thrown_message([] { with_weights({0.0, 0.0}); }), "all weights are zero");
  EXPECT_EQ(thrown_message([] {
              with_weights({1.0, -0.5});
            }),
            "weight 1 is -0.5, expected a finite number >= 0");
  EXPECT_EQ(thrown_message([] { with_weights({kNan}); }),
            "weight 0 is nan, expected a finite number >= 0");
  EXPECT_EQ(thrown_message([] {
              with_weights({1.0, kInfinity});
            }),
            "weight 1 is inf, expected a finite number >= 0");
}

TEST(Mixture, RejectsSizesThatDiffer) {
  EXPECT_EQ(thrown_message([] {
              LineMixture::from_weights(std::vector{0.5, 0.5}, {on_line(0.0, 1.0)});
            }),
            "2 weights for 1 components");
  const auto stack = [](std::size_t size) {
    const auto n = static_cast<Eigen::Index>(6 * size);
    return ConcentratedGaussian<PoseStackd>(PoseStackd(size), Eigen::MatrixXd::Identity(n, n));
  };
  EXPECT_EQ(thrown_message([&] {
              Mixture<ConcentratedGaussian<PoseStackd>>::from_weights(std::vector{0.5, 0.5},
                                                                      {stack(1), stack(2)});
            }),
            "mixture components of 6 and 12 degrees of freedom");
}

template <class G>
class MixtureOn : public ::testing::Test {};
using MixtureGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(MixtureOn, MixtureGroups);

TYPED_TEST(MixtureOn, DensityIsTheWeightedSum) {
  testing::check_property([] {
    const auto components = testing::draw_components<TypeParam>(3, 0.2, 0.5);
    const auto x = testing::draw_near_identity<TypeParam>(0.2) * components[1].density.mean();
    double weights = 0.0;
    double sum = 0.0;
    for (const auto& component : components) {
      weights += std::exp(component.log_weight);
      sum += std::exp(component.log_weight + component.density.log_density(x));
    }
    const Mixture mixture(components);
    const double expected = std::log(sum / weights);
    RC_ASSERT(std::abs(mixture.log_density(x) - expected) < 1e-10 * (1.0 + std::abs(expected)));
  });
}

TEST(Mixture, DensityFarFromEveryComponentDoesNotUnderflow) {
  const auto mixture = LineMixture::from_weights(std::vector{0.5, 0.5, 0.0},
                                                 {on_line(0, 1), on_line(2, 1), on_line(100, 1)});
  // The nearer component, 98 deviations away, alone: log(0.5) - log(2 pi) / 2 - 98^2 / 2.
  const double expected =
      std::log(0.5) - 0.5 * std::log(2.0 * std::numbers::pi) - 0.5 * 98.0 * 98.0;
  EXPECT_NEAR(mixture.log_density(Rnd<1>(Eigen::Matrix<double, 1, 1>(100.0))), expected, 1e-9);
}

TEST(Mixture, SamplesComponentsByWeight) {
  const auto mixture = LineMixture::from_weights(
      std::vector{0.2, 0.0, 0.5, 0.3},
      {on_line(-100, 1), on_line(0, 1), on_line(100, 4), on_line(200, 1)});
  constexpr int kDraws = 60'000;
  std::vector<int> counts(4);
  testing::SampleMoments moments(1);
  RandomStream stream(31);
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd value = mixture.sample(stream).value();
    ++counts[static_cast<std::size_t>(std::lround(value[0] / 100.0)) + 1];
    moments.add(value);
  }
  EXPECT_EQ(counts[1], 0);
  for (const std::size_t i : {0U, 2U, 3U}) {
    const double w = mixture.weight(i);
    EXPECT_NEAR(counts[i], w * kDraws, 4.5 * std::sqrt(w * (1.0 - w) * kDraws)) << i;
  }
  // Mean 0.2 (-100) + 0.5 100 + 0.3 200 = 90; E[x^2] = 0.2 10001 + 0.5 10004 + 0.3 40001 = 19002.5.
  const Eigen::MatrixXd variance = Eigen::MatrixXd::Constant(1, 1, 19002.5 - 8100.0);
  EXPECT_LT(moments.worst_score(Eigen::VectorXd::Constant(1, 90.0), variance), 4.5);
}

TEST(Mixture, PruneReturnsTheWeightDropped) {
  LineMixture mixture = with_weights({0.5, 0.001, 0.0, 0.4, 0.099});
  EXPECT_NEAR(mixture.prune(0.1), 0.1, 1e-15);
  ASSERT_EQ(mixture.size(), 2U);
  EXPECT_NEAR(mixture.weight(0), 0.5 / 0.9, 1e-15);
  EXPECT_NEAR(mixture.weight(1), 0.4 / 0.9, 1e-15);
}

TEST(Mixture, PruneKeepsWeightsAtTheThresholdAndTheHeaviest) {
  LineMixture at_threshold = with_weights({0.75, 0.25});
  EXPECT_EQ(at_threshold.prune(at_threshold.weight(1)), 0.0);
  EXPECT_EQ(at_threshold.size(), 2U);

  LineMixture equal = with_weights({1.0, 1.0, 1.0, 1.0});
  EXPECT_NEAR(equal.prune(0.5), 0.75, 1e-15);
  ASSERT_EQ(equal.size(), 1U);
  EXPECT_EQ(equal.weight(0), 1.0);

  LineMixture with_zero = with_weights({1.0, 0.0});
  EXPECT_EQ(with_zero.prune(0.0), 0.0);
  EXPECT_EQ(with_zero.size(), 2U);
}

TEST(Mixture, PruneRefusesAThresholdThatIsNoNumber) {
  LineMixture mixture = with_weights({0.75, 0.25});
  EXPECT_NE(thrown_message([&] { mixture.prune(kNan); }).find("threshold is nan"),
            std::string::npos);
  EXPECT_EQ(mixture.size(), 2U);
}

TEST(Mixture, ReleaseGivesTheNormalisedComponents) {
  const auto components = with_weights({2.0, 6.0}).release();
  ASSERT_EQ(components.size(), 2U);
  EXPECT_NEAR(std::exp(components[0].log_weight), 0.25, 1e-15);
}

}  // namespace
}  // namespace posemix
