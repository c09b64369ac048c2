// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/reduce.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using Line = ConcentratedGaussian<Rnd<1>>;

Line unit_on_line(double mean, double variance = 1.0) {
  using Scalar1 = Eigen::Matrix<double, 1, 1>;
  return {Rnd<1>(Scalar1(mean)), Scalar1(variance)};
}

/// Components of unit variance at 0, 1, 2, ... with weights proportional to 1, 2, 3, ...
Mixture<Line> ladder(std::size_t count) {
  std::vector<double> weights(count);
  std::iota(weights.begin(), weights.end(), 1.0);
  std::vector<Line> densities;
  for (std::size_t i = 0; i < count; ++i) densities.push_back(unit_on_line(static_cast<double>(i)));
  return Mixture<Line>::from_weights(weights, std::move(densities));
}

TEST(Reduce, MergesDownToTheLargestCountAllowed) {
  for (const std::size_t allowed : {1U, 2U, 5U, 9U, 10U, 20U}) {
    const auto [mixture, report] = reduce(ladder(10), {.max_components = allowed});
    const std::size_t left = std::min<std::size_t>(allowed, 10);
    EXPECT_EQ(mixture.size(), left);
    EXPECT_EQ(report.components_before, 10U);
    EXPECT_EQ(report.components_pruned, 0U);
    EXPECT_EQ(report.components_after, left);
    EXPECT_EQ(report.merges.size(), 10 - left);
    EXPECT_TRUE(report.converged);
  }
}

TEST(Reduce, TriggerOfThePublishedFilter) {
  // Merging begins at 16 components and goes on to 12; 13 to 15 components pass.
  const ReductionSettings settings{.max_components = 12, .merge_from = 16};
  for (const std::size_t count : {12U, 13U, 15U}) {
    EXPECT_EQ(reduce(ladder(count), settings).mixture.size(), count);
    EXPECT_TRUE(reduce(ladder(count), settings).report.merges.empty());
  }
  for (const std::size_t count : {16U, 17U, 24U}) {
    EXPECT_EQ(reduce(ladder(count), settings).mixture.size(), 12U);
  }
}

TEST(Reduce, TriggerCountsWhatIsLeftAfterPruning) {
  auto components = ladder(15).release();
  components.push_back({std::log(1e-7), unit_on_line(50.0)});
  const ReductionSettings settings{.prune_below = 1e-6, .max_components = 12, .merge_from = 16};
  EXPECT_EQ(reduce(Mixture(components), settings).mixture.size(), 15U);
  const ReductionSettings keeping{.prune_below = 1e-8, .max_components = 12, .merge_from = 16};
  EXPECT_EQ(reduce(Mixture(components), keeping).mixture.size(), 12U);
}

TEST(Reduce, PruningReportsTheWeightDropped) {
  const auto mixture = Mixture<Line>::from_weights(std::vector{0.6, 4e-6, 0.3, 0.0, 0.099996},
                                                   std::vector<Line>(5, unit_on_line(0.0)));
  const auto [reduced, report] = reduce(mixture);  // prunes below 5e-6 by default
  EXPECT_EQ(reduced.size(), 3U);
  EXPECT_EQ(report.components_pruned, 2U);
  EXPECT_NEAR(report.weight_pruned, 4e-6, 1e-18);
  EXPECT_NEAR(reduced.weight(0), 0.6 / (1.0 - 4e-6), 1e-15);
}

TEST(Reduce, KeepsTheHeaviestWithoutMerging) {
  const auto mixture = Mixture<Line>::from_weights(
      std::vector{0.1, 0.4, 0.2, 0.1, 0.2},
      {unit_on_line(0), unit_on_line(1), unit_on_line(2), unit_on_line(3), unit_on_line(4)});
  const auto [reduced, report] = reduce(mixture, {.keep_heaviest = 2});
  ASSERT_EQ(reduced.size(), 2U);
  // In the order they had; of the two of weight 0.2 the earlier.
  EXPECT_EQ(reduced[0].density.mean().value()[0], 1.0);
  EXPECT_EQ(reduced[1].density.mean().value()[0], 2.0);
  EXPECT_NEAR(reduced.weight(0), 2.0 / 3.0, 1e-15);
  EXPECT_EQ(report.components_pruned, 3U);
  EXPECT_NEAR(report.weight_pruned, 0.4, 1e-15);
  EXPECT_TRUE(report.merges.empty());
}

TEST(Reduce, KeepsTheHeaviestAfterPruningAndBeforeMerging) {
  const ReductionSettings settings{.prune_below = 0.02, .keep_heaviest = 6, .max_components = 4};
  // Weights 1/55 .. 10/55: the first is pruned, then three dropped, then two merges.
  const auto [reduced, report] = reduce(ladder(10), settings);
  EXPECT_EQ(reduced.size(), 4U);
  EXPECT_EQ(report.components_pruned, 4U);
  EXPECT_NEAR(report.weight_pruned, 10.0 / 55.0, 1e-15);
  EXPECT_EQ(report.merges.size(), 2U);
  // No component is dropped if there are not more than six.
  EXPECT_EQ(reduce(ladder(6), {.keep_heaviest = 6}).report.components_pruned, 0U);
  EXPECT_EQ(reduce(ladder(6), {.keep_heaviest = 0}).mixture.size(), 6U);
}

TEST(Reduce, ReportTellsEveryMerge) {
  // By hand, the largest with the smallest: 0.5 at 0 takes 0.1 at 4; then 0.6 takes 0.15 at 1.
  const auto mixture = Mixture<Line>::from_weights(
      std::vector{0.5, 0.15, 0.25, 0.1},
      {unit_on_line(0), unit_on_line(1), unit_on_line(2), unit_on_line(4)});
  const auto [reduced, report] = reduce(mixture, {.max_components = 2});
  ASSERT_EQ(report.merges.size(), 2U);
  EXPECT_NEAR(report.merges[0].weight_a, 0.5, 1e-14);
  EXPECT_NEAR(report.merges[0].weight_b, 0.1, 1e-14);
  EXPECT_NEAR(report.merges[0].distance, 4.0, 1e-14);
  EXPECT_NEAR(report.merges[1].weight_a, 0.6, 1e-14);
  EXPECT_NEAR(report.merges[1].weight_b, 0.15, 1e-14);
  EXPECT_NEAR(report.merges[1].distance, 1.0 - 2.0 / 3.0, 1e-14);
  EXPECT_NEAR(report.weight_moved, 0.25, 1e-14);
  ASSERT_EQ(reduced.size(), 2U);
  EXPECT_NEAR(reduced.weight(0), 0.75, 1e-14);
  EXPECT_NEAR(reduced.weight(1), 0.25, 1e-14);
  // (0.5 0 + 0.15 1 + 0.1 4) / 0.75, and the third untouched.
  EXPECT_NEAR(reduced[0].density.mean().value()[0], 0.55 / 0.75, 1e-14);
  EXPECT_EQ(reduced[1].density.mean().value()[0], 2.0);
}

TEST(Reduce, ObeysThePairRuleAndTheMetric) {
  const auto mixture = Mixture<Line>::from_weights(
      std::vector{0.4, 0.3, 0.2, 0.1},
      {unit_on_line(0), unit_on_line(5), unit_on_line(0.1), unit_on_line(2)});
  const auto distance_of = [&](PairRule rule) {
    return reduce(mixture, {.max_components = 3, .pair = rule}).report.merges.at(0).distance;
  };
  EXPECT_NEAR(distance_of(PairRule::largest_with_smallest), 2.0, 1e-14);
  EXPECT_NEAR(distance_of(PairRule::most_distant), 5.0, 1e-14);
  EXPECT_NEAR(distance_of(PairRule::symmetric_kl), 0.1, 1e-14);
  EXPECT_NEAR(distance_of(PairRule::runnalls), 0.1, 1e-14);
}

TEST(Reduce, ToOneComponentIsTheMomentsOfTheMixtureOnVectors) {
  testing::check_property([] {
    const Mixture mixture(testing::draw_components<Rnd<3>>(6, 2.0, 0.5));
    const auto expected = moments(mixture).density;
    const auto pair = *rc::gen::element(PairRule::largest_with_smallest, PairRule::most_distant,
                                        PairRule::runnalls, PairRule::symmetric_kl);
    const auto reduced =
        reduce(mixture, {.prune_below = 0.0, .max_components = 1, .pair = pair}).mixture;
    RC_ASSERT(reduced.size() == 1U);
    RC_ASSERT(reduced[0].density.mean().is_approx(expected.mean(), 1e-11));
    RC_ASSERT(testing::relative_difference(reduced[0].density.covariance(), expected.covariance()) <
              1e-10);
  });
}

template <class G>
class ReduceOn : public ::testing::Test {};
using ReduceGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(ReduceOn, ReduceGroups);

TYPED_TEST(ReduceOn, KeepsInvariantsWithEveryRule) {
  testing::check_property([] {
    using G = TypeParam;
    const Mixture mixture(testing::draw_components<G>(7, 0.4, 0.1));
    for (const MergeRule rule :
         {MergeRule::midway, MergeRule::tangent_of_larger, MergeRule::moment_matched}) {
      for (const PairRule pair : {PairRule::largest_with_smallest, PairRule::most_distant,
                                  PairRule::runnalls, PairRule::symmetric_kl}) {
        const ReductionSettings settings{
            .max_components = 3, .pair = pair, .merge = {.rule = rule}};
        const auto [reduced, report] = reduce(mixture, settings);
        RC_ASSERT(report.converged);
        RC_ASSERT(reduced.size() == 3U);
        double weight = 0.0;
        for (std::size_t i = 0; i < reduced.size(); ++i) {
          const auto& covariance = reduced[i].density.covariance();
          weight += reduced.weight(i);
          RC_ASSERT(covariance == covariance.transpose());
          RC_ASSERT(covariance.llt().info() == Eigen::Success);
        }
        RC_ASSERT(std::abs(weight - 1.0) < 1e-13);
      }
    }
  });
}

TEST(Reduce, ComponentsWithoutWeightMergeAway) {
  const auto mixture = Mixture<Line>::from_weights(
      std::vector{0.0, 0.0, 1.0, 0.0},
      {unit_on_line(1), unit_on_line(2), unit_on_line(3), unit_on_line(4)});
  for (const PairRule pair : {PairRule::largest_with_smallest, PairRule::most_distant,
                              PairRule::runnalls, PairRule::symmetric_kl}) {
    const ReductionSettings settings{.prune_below = 0.0, .max_components = 1, .pair = pair};
    const auto [reduced, report] = reduce(mixture, settings);
    ASSERT_EQ(reduced.size(), 1U);
    EXPECT_EQ(reduced.weight(0), 1.0);
    EXPECT_NEAR(reduced[0].density.mean().value()[0], 3.0, 1e-14);
    EXPECT_EQ(report.weight_moved, 0.0);
  }
}

TEST(Reduce, ReportsAMeanThatHasNotConverged) {
  using D = ConcentratedGaussian<SO3d>;
  const Eigen::Matrix3d p = 0.01 * Eigen::Matrix3d::Identity();
  const auto mixture =
      Mixture<D>::from_weights(std::vector{0.6, 0.4}, {D(SO3d(), p), D(SO3d::exp({1, 0.5, 0}), p)});
  const MergeSettings stopped{.rule = MergeRule::moment_matched, .max_iterations = 0};
  EXPECT_FALSE(reduce(mixture, {.max_components = 1, .merge = stopped}).report.converged);
}

TEST(Reduce, RejectsUnusableSettings) {
  const auto message = [](const ReductionSettings& settings) {
    return testing::thrown_message([&] { reduce(ladder(3), settings); });
  };
  const std::string is = "reduce: prune_below is ";
  const std::string range = ", expected a number in [0, 1)";
  EXPECT_EQ(message({.max_components = 0}), "reduce: max_components is 0, expected at least 1");
  EXPECT_EQ(message({.prune_below = -1e-9}), is + "-1e-09" + range);
  EXPECT_EQ(message({.prune_below = 1.0}), is + "1" + range);
  EXPECT_EQ(message({.prune_below = std::numeric_limits<double>::quiet_NaN()}), is + "nan" + range);
  EXPECT_EQ(message({.prune_below = 0.0}), "");
}

}  // namespace
}  // namespace posemix
