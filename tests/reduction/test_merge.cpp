// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/merge.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::Components;
using testing::draw_components;
using testing::draw_near_identity;
using testing::relative_difference;

constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();
constexpr std::array kRules{MergeRule::midway, MergeRule::tangent_of_larger,
                            MergeRule::moment_matched};

template <class G>
MergeResult<ConcentratedGaussian<G>> merged_by(MergeRule rule, const Components<G>& components) {
  return merge<G>(components, {.rule = rule});
}

/// Asserts that two components agree up to `tolerance`, the covariances relative.
template <class G>
void assert_same(const Component<ConcentratedGaussian<G>>& actual,
                 const Component<ConcentratedGaussian<G>>& expected, double tolerance) {
  RC_ASSERT(actual.log_weight == expected.log_weight ||
            std::abs(actual.log_weight - expected.log_weight) < 1e-11);
  RC_ASSERT(actual.density.mean().is_approx(expected.density.mean(), tolerance));
  RC_ASSERT(relative_difference(actual.density.covariance(), expected.density.covariance()) <
            tolerance);
}

TEST(MergeOnVectors, EveryRulePreservesMoments) {
  // Midway-merge paper, eq. 8, in the form for any number of components.
  check_property([] {
    const auto count = static_cast<std::size_t>(testing::draw_integer(2, 6));
    const auto components = draw_components<Rnd<3>>(count, 2.0, 0.7);
    double weight = 0.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& c : components) {
      weight += std::exp(c.log_weight);
      mean += std::exp(c.log_weight) * c.density.mean().value();
    }
    mean /= weight;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& c : components) {
      const Eigen::Vector3d d = c.density.mean().value() - mean;
      covariance += std::exp(c.log_weight) / weight * (c.density.covariance() + d * d.transpose());
    }
    const Component<ConcentratedGaussian<Rnd<3>>> expected{
        std::log(weight), ConcentratedGaussian<Rnd<3>>(Rnd<3>(mean), covariance)};
    for (const MergeRule rule : kRules) {
      const auto result = merged_by(rule, components);
      RC_ASSERT(result.converged);
      assert_same(result.component, expected, 1e-11);
    }
  });
}

template <class G>
class MergeOn : public ::testing::Test {};
using MergeGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(MergeOn, MergeGroups);

TYPED_TEST(MergeOn, OneComponentStaysAsItIs) {
  check_property([] {
    const auto components = draw_components<TypeParam>(1, 0.5, 0.3);
    for (const MergeRule rule : kRules) {
      const auto result = merged_by(rule, components);
      RC_ASSERT(result.converged);
      RC_ASSERT(result.component.log_weight == components[0].log_weight);
      RC_ASSERT(result.component.density.covariance() == components[0].density.covariance());
      RC_ASSERT(result.component.density.mean().is_approx(components[0].density.mean(), 1e-15));
    }
  });
}

TYPED_TEST(MergeOn, IdenticalComponentsAddTheirWeights) {
  check_property([] {
    const auto drawn = draw_components<TypeParam>(2, 0.5, 0.3);
    auto expected = drawn[0];
    const Components<TypeParam> twins{drawn[0], {drawn[1].log_weight, drawn[0].density}};
    expected.log_weight = std::log(std::exp(drawn[0].log_weight) + std::exp(drawn[1].log_weight));
    for (const MergeRule rule : kRules)
      assert_same(merged_by(rule, twins).component, expected, 1e-9);
  });
}

TYPED_TEST(MergeOn, ComponentsWithoutWeightAreIgnored) {
  check_property([] {
    const auto components = draw_components<TypeParam>(3, 0.5, 0.3);
    auto one_left = components;
    one_left[0].log_weight = kMinusInfinity;
    one_left[2].log_weight = kMinusInfinity;
    auto two_left = components;
    two_left[1].log_weight = kMinusInfinity;
    for (const MergeRule rule : kRules) {
      assert_same(merged_by(rule, one_left).component, components[1], 1e-12);
      assert_same(merged_by(rule, two_left).component,
                  merged_by(rule, Components<TypeParam>{components[0], components[2]}).component,
                  1e-12);
    }
  });
}

TYPED_TEST(MergeOn, WeightlessComponentsCountEqually) {
  check_property([] {
    const auto components = draw_components<TypeParam>(3, 0.5, 0.3);
    auto weightless = components;
    auto equal = components;
    for (auto& c : weightless) c.log_weight = kMinusInfinity;
    for (auto& c : equal) c.log_weight = 0.0;
    for (const MergeRule rule : kRules) {
      auto expected = merged_by(rule, equal).component;
      expected.log_weight = kMinusInfinity;
      assert_same(merged_by(rule, weightless).component, expected, 1e-12);
    }
  });
}

TYPED_TEST(MergeOn, WeightsFarBelowUnderflowKeepTheirRatio) {
  check_property([] {
    const auto components = draw_components<TypeParam>(2, 0.5, 0.3);
    auto tiny = components;
    for (auto& c : tiny) c.log_weight -= 2000.0;
    for (const MergeRule rule : kRules) {
      auto expected = merged_by(rule, components).component;
      expected.log_weight -= 2000.0;
      assert_same(merged_by(rule, tiny).component, expected, 1e-9);
    }
  });
}

TYPED_TEST(MergeOn, CovarianceStaysPositiveDefinite) {
  check_property([] {
    const auto components = draw_components<TypeParam>(4, 0.5, 1e-3);
    for (const MergeRule rule : kRules) {
      const auto covariance = merged_by(rule, components).component.density.covariance();
      RC_ASSERT(covariance == covariance.transpose());
      RC_ASSERT(covariance.llt().info() == Eigen::Success);
    }
  });
}

/// The components left * X * right, in the frames that result.
template <class G>
Components<G> moved(const G& left, Components<G> components, const G& right) {
  for (auto& c : components) {
    c.density = {left * c.density.mean() * right, left.adjoint_congruence(c.density.covariance())};
  }
  return components;
}

TYPED_TEST(MergeOn, CommutesWithRightTranslation) {
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(3, 0.4, 0.2);
    const G right = draw_near_identity<G>(1.0);
    for (const MergeRule rule : kRules) {
      const auto before = merged_by(rule, components).component;
      const auto expected = moved(right.identity(), Components<G>{before}, right)[0];
      assert_same(merged_by(rule, moved(right.identity(), components, right)).component, expected,
                  1e-8);
    }
  });
}

TYPED_TEST(MergeOn, CommutesWithLeftTranslation) {
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(3, 0.2, 0.05);
    const G left = draw_near_identity<G>(1.0);
    for (const MergeRule rule : kRules) {
      // The cubature of moment_matched does so up to terms of fourth order.
      const double tolerance = rule == MergeRule::moment_matched ? 5e-3 : 1e-8;
      const auto before = merged_by(rule, components).component;
      const auto expected = moved(left, Components<G>{before}, left.identity())[0];
      assert_same(merged_by(rule, moved(left, components, left.identity())).component, expected,
                  tolerance);
    }
  });
}

TYPED_TEST(MergeOn, OrderOfTheComponentsDoesNotMatter) {
  check_property([] {
    // Weights drawn differ, or tangent_of_larger would have to take the first.
    auto components = draw_components<TypeParam>(3, 0.4, 0.2);
    for (std::size_t i = 0; i < 3; ++i) components[i].log_weight += static_cast<double>(10 * i);
    for (std::size_t i = 0; i < 3; ++i) components[i].log_weight *= 0.1;
    const Components<TypeParam> rotated{components[2], components[0], components[1]};
    const Components<TypeParam> swapped{components[1], components[0], components[2]};
    for (const MergeRule rule : kRules) {
      const auto expected = merged_by(rule, components).component;
      assert_same(merged_by(rule, rotated).component, expected, 1e-8);
      assert_same(merged_by(rule, swapped).component, expected, 1e-8);
    }
  });
}

TEST(Merge, MomentMatchedAgreesWithMonteCarlo) {
  Matrix6d root = 0.12 * Matrix6d::Identity();
  for (Eigen::Index i = 1; i < 6; ++i) root(i, i - 1) = 0.05;
  const Matrix6d p = root * root.transpose();
  const Vector6d step = (Vector6d() << 0.5, -0.3, 0.4, 0.2, 0.6, -0.3).finished();
  const SE3d centre = SE3d::exp((Vector6d() << 1.0, 0.3, -0.7, 2.0, -1.0, 0.5).finished());
  const Components<SE3d> components{{std::log(0.7), {centre, p}},
                                    {std::log(0.3), {SE3d::exp(step) * centre, 1.5 * p}}};
  const auto result = merged_by(MergeRule::moment_matched, components);
  EXPECT_TRUE(result.converged);
  const Mixture mixture(components);
  testing::SampleMoments sample(6);
  const SE3d inverse_mean = result.component.density.mean().inverse();
  RandomStream stream(61);
  for (int i = 0; i < 100'000; ++i) sample.add((mixture.sample(stream) * inverse_mean).log());
  EXPECT_LT(sample.worst_score(Vector6d::Zero(), result.component.density.covariance(), 1e-3), 4.5);
}

TEST(Merge, MomentMatchedReportsWhenItHasNotConverged) {
  const Components<SO3d> components{
      {0.0, {SO3d(), 0.01 * Eigen::Matrix3d::Identity()}},
      {0.1, {SO3d::exp({1, 0.5, 0}), 0.04 * Eigen::Matrix3d::Identity()}}};
  EXPECT_FALSE(
      merge<SO3d>(components, {.rule = MergeRule::moment_matched, .max_iterations = 0}).converged);
}

TEST(MergeOnVectors, OfOneComponentSeveralTimesIsItWhateverTheWeights) {
  const Eigen::Vector3d mean(1e6, -1e6, 1e6);
  const ConcentratedGaussian<Rnd<3>> one(Rnd<3>(mean), 1e-6 * Eigen::Matrix3d::Identity());
  // Normalised weights of the last do not sum to one: their logarithms have seven digits.
  for (const double log_weight : {0.0, -700.0, -1e9}) {
    const std::vector<Component<ConcentratedGaussian<Rnd<3>>>> three(3, {log_weight, one});
    const auto merged = merged_by(MergeRule::midway, three).component.density;
    EXPECT_EQ(merged.mean().value(), mean);
    EXPECT_LT((merged.covariance() - one.covariance()).norm(), 1e-20);
  }
}

TEST(MergeOnVectors, RefusesSeveralDimensions) {
  using Any = Rnd<Eigen::Dynamic>;
  const auto zero = [](Eigen::Index n) {
    return Component<ConcentratedGaussian<Any>>{
        0.0, {Any(Eigen::VectorXd::Zero(n)), Eigen::MatrixXd::Identity(n, n)}};
  };
  const std::vector<Component<ConcentratedGaussian<Any>>> components{zero(2), zero(3)};
  for (const MergeRule rule : kRules) {
    EXPECT_EQ(testing::thrown_message([&] { merged_by(rule, components); }),
              "merge: components of 2 and 3 degrees of freedom");
  }
}

TEST(Merge, RejectsWhatItCannotMerge) {
  EXPECT_EQ(testing::thrown_message([] { merged_by(MergeRule::midway, Components<SO3d>{}); }),
            "merge: there is no component");
  const Component<ConcentratedGaussian<SO3d>> one{0.0, {SO3d(), Eigen::Matrix3d::Identity()}};
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -kMinusInfinity}) {
    Component<ConcentratedGaussian<SO3d>> other = one;
    other.log_weight = bad;
    const std::string end = fmt::format(" is {}, expected a number or -inf", bad);
    for (const MergeRule rule : kRules) {
      const auto message = [&](const Components<SO3d>& components) {
        return testing::thrown_message([&] { merged_by(rule, components); });
      };
      EXPECT_EQ(message({other, one}), "log-weight 0" + end);
      EXPECT_EQ(message({one, one, other}), "log-weight 2" + end);
      EXPECT_EQ(message({other}), "log-weight 0" + end);
    }
    EXPECT_EQ(testing::thrown_message([&] {
                midway_point<SO3d>(Components<SO3d>{one, other});
              }),
              "log-weight 1" + end);
  }
  EXPECT_EQ(testing::thrown_message([&] {
              merged_by(static_cast<MergeRule>(7), Components<SO3d>{one, one});
            }),
            "merge: unknown rule");
  const Component<ConcentratedGaussian<Rnd<3>>> vector{0.0,
                                                       {Rnd<3>(), Eigen::Matrix3d::Identity()}};
  EXPECT_EQ(testing::thrown_message([&] {
              merged_by(static_cast<MergeRule>(7), Components<Rnd<3>>{vector, vector});
            }),
            "merge: unknown rule");
}

}  // namespace
}  // namespace posemix
