// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "divergence/small_mixtures.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/reduction/reduce.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::correlated;
using Rotation = ProjectedGaussian<SO3d>;
using Pose = ProjectedGaussian<SE3d>;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array kProjectedMergeRules{MergeRule::midway, MergeRule::tangent_of_larger,
                                          MergeRule::moment_matched};
constexpr std::array kProjectedPairRules{PairRule::largest_with_smallest, PairRule::most_distant,
                                         PairRule::runnalls, PairRule::symmetric_kl,
                                         PairRule::weighted_symmetric_kl};

template <class G>
Mixture<ProjectedGaussian<G>> random_mixture(RandomStream& stream, std::size_t size, double away,
                                             double deviation) {
  std::vector<Component<ProjectedGaussian<G>>> components;
  for (std::size_t i = 0; i < size; ++i) {
    typename G::Tangent xi;
    for (double& value : xi) value = away * stream.normal();
    components.push_back(
        {std::log(stream.uniform()),
         {G::exp(xi), typename G::TangentMatrix(correlated(stream, G::Dof, deviation))}});
  }
  return Mixture<ProjectedGaussian<G>>(std::move(components));
}

template <class D>
MergeResult<D> merged(const Mixture<D>& mixture, MergeRule rule) {
  return merge(std::span<const Component<D>>(mixture.components()), MergeSettings{.rule = rule});
}

Rotation isotropic(double angle, double deviation) {
  return {SO3d::exp({angle, 0.0, 0.0}),
          Eigen::Matrix3d(deviation * deviation * Eigen::Matrix3d::Identity())};
}

/// Two of 12 degrees, .65 and .35.
Mixture<Rotation> two(double separation) {
  return Mixture<Rotation>({{std::log(0.65), isotropic(0.0, 6.0 * kDegree)},
                            {std::log(0.35), isotropic(separation * kDegree, 6.0 * kDegree)}});
}

double loss(const Mixture<Rotation>& before, const Rotation& after) {
  RandomStream stream(1);
  return kl_monte_carlo(before, Mixture<Rotation>({{0.0, after}}), stream,
                        {.samples = 1 << 14, .replicates = 8})
      .value;
}

TEST(ProjectedMerge, InOneTangentSpaceIsThatOfGaussians) {
  RandomStream stream(3);
  const SO3d q = SO3d::exp({0.3, 0.1, -0.4});
  const Matrix6d p_a = correlated(stream, 6, 0.2);
  const Matrix6d p_b = correlated(stream, 6, 0.3);
  const Eigen::Vector3d t_a(0.1, 0.2, 0.3);
  const Eigen::Vector3d t_b(-0.3, 0.1, 0.2);
  const Mixture<Pose> mixture(
      {{std::log(0.3), Pose(SE3d(q, t_a), p_a)}, {std::log(0.7), Pose(SE3d(q, t_b), p_b)}});
  Vector6d d = Vector6d::Zero();
  d.tail<3>() = t_b - t_a;
  const Matrix6d expected = 0.3 * p_a + 0.7 * p_b + 0.21 * d * d.transpose();
  for (const MergeRule rule : {MergeRule::midway, MergeRule::tangent_of_larger}) {
    const Pose result = merged(mixture, rule).component.density;
    EXPECT_TRUE(result.mean().is_approx(SE3d(q, 0.3 * t_a + 0.7 * t_b), 1e-12));
    EXPECT_LT(testing::relative_difference(result.covariance(), expected), 1e-12);
  }
}

TEST(ProjectedMerge, MomentsOfOneDensityGiveItBack) {
  RandomStream stream(4);
  const Pose density(SE3d(SO3d::exp({0.3, 0.1, -0.4}), {1.0, 2.0, 3.0}),
                     Matrix6d(correlated(stream, 6, 0.2)));
  const auto result = moments(Mixture<Pose>({{0.0, density}}));
  EXPECT_TRUE(result.converged);
  EXPECT_TRUE(result.density.mean().is_approx(density.mean(), 1e-12));
  EXPECT_LT(testing::relative_difference(result.density.covariance(), density.covariance()), 1e-11);
}

TEST(ProjectedMerge, MomentsAreThoseOfSamples) {
  RandomStream stream(5);
  const auto mixture = random_mixture<SE3d>(stream, 3, 0.3, 0.1);
  const Pose result = moments(mixture).density;
  const DistributionMoments<SE3d> distribution = moments_of(result);
  testing::SampleMoments samples(6);
  for (int i = 0; i < 100000; ++i) samples.add(result.coordinates(mixture.sample(stream)));
  EXPECT_LT(samples.worst_score(distribution.mean, distribution.covariance, 1e-3), 5.0);
}

TEST(ProjectedMerge, MatchingTheMomentsOfTheLawLosesTheLeast) {
  // Divergences found by sampling 2^18 points; the noted ones of another pair of 12 degrees, at 20,
  // 60 and 120 degrees, are .0345 .351 1.057 recentred and .0337 .335 .940 at the optimum.
  struct Case {
    double separation;
    std::array<double, 3> kl;  ///< by merge rule
  };
  for (const Case& one :
       {Case{20.0, {0.00536, 0.00529, 0.00474}}, Case{60.0, {0.33546, 0.32959, 0.31931}},
        Case{120.0, {1.02707, 1.04506, 0.91132}}}) {
    const auto before = two(one.separation);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto result = merged(before, kProjectedMergeRules[i]);
      EXPECT_TRUE(result.converged);
      EXPECT_NEAR(loss(before, result.component.density), one.kl[i], 2e-3 * one.kl[i] + 2e-4);
    }
  }
}

TEST(ProjectedMerge, NoNeighbourOfMatchedMomentsIsMuchBetter) {
  for (const double separation : {20.0, 60.0, 120.0}) {
    const auto before = two(separation);
    const Rotation matched = merged(before, MergeRule::moment_matched).component.density;
    const double best = loss(before, matched);
    for (const double turn : {-2.0 * kDegree, 0.0, 2.0 * kDegree}) {
      for (const double along : {0.9, 1.0, 1.1}) {
        for (const double across : {0.95, 1.0, 1.05}) {
          const Eigen::Vector3d scale(along, across, across);
          const Rotation neighbour(
              matched.mean() * SO3d::exp({turn, 0.0, 0.0}),
              Eigen::Matrix3d(scale.asDiagonal() * matched.covariance() * scale.asDiagonal()));
          EXPECT_GT(loss(before, neighbour), best - 0.005 * best - 1e-4);
        }
      }
    }
  }
}

TEST(ProjectedMerge, FarApartItConvergesWithEveryRule) {
  for (const double separation : {150.0, 175.0, 179.9}) {
    for (const MergeRule rule : kProjectedMergeRules) {
      const auto result = merged(two(separation), rule);
      EXPECT_TRUE(result.converged);
      EXPECT_TRUE(result.component.density.covariance().allFinite());
    }
  }
  EXPECT_THROW(merge<SO3d>(std::span<const Component<Rotation>>()), InvalidInput);
}

TEST(ProjectedMerge, RefusesAWeightThatIsNone) {
  RandomStream stream(6);
  auto components = random_mixture<SE3d>(stream, 2, 0.3, 0.1).release();
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    components[1].log_weight = bad;
    const std::span<const Component<Pose>> both(components);
    for (const MergeRule rule : kProjectedMergeRules) {
      EXPECT_THROW(merge<SE3d>(both, {.rule = rule}), InvalidInput);
      EXPECT_THROW(merge<SE3d>(both.last(1), {.rule = rule}), InvalidInput);
    }
  }
}

TEST(ProjectedMerge, WithoutWeightAComponentDoesNotCount) {
  RandomStream stream(6);
  auto components = random_mixture<SE3d>(stream, 3, 0.3, 0.1).release();
  components[1].log_weight = -std::numeric_limits<double>::infinity();
  const std::vector two_of_them{components[0], components[2]};
  for (const MergeRule rule : kProjectedMergeRules) {
    const auto all = merge<SE3d>(std::span<const Component<Pose>>(components), {.rule = rule});
    const auto carrying =
        merge<SE3d>(std::span<const Component<Pose>>(two_of_them), {.rule = rule});
    EXPECT_EQ(all.component.density.covariance(), carrying.component.density.covariance());
    EXPECT_EQ(all.component.log_weight, carrying.component.log_weight);
  }
}

TEST(ProjectedReduce, KeepsInvariantsWithEveryRule) {
  RandomStream stream(7);
  for (int trial = 0; trial < 5; ++trial) {
    const auto mixture = random_mixture<SE3d>(stream, 8, 0.4, 0.1);
    for (const MergeRule rule : kProjectedMergeRules) {
      for (const PairRule pair : kProjectedPairRules) {
        const auto [reduced, report] = reduce(
            mixture,
            {.drop_smallest = 2, .max_components = 3, .pair = pair, .merge = {.rule = rule}});
        EXPECT_TRUE(report.converged);
        ASSERT_EQ(reduced.size(), 3U);
        EXPECT_EQ(report.components_pruned, 2U);
        EXPECT_EQ(report.merges.size(), 3U);
        double weight = 0.0;
        for (std::size_t i = 0; i < reduced.size(); ++i) {
          const auto& density = reduced[i].density;
          weight += reduced.weight(i);
          EXPECT_EQ(density.covariance(), density.covariance().transpose());
          EXPECT_EQ(density.covariance().llt().info(), Eigen::Success);
        }
        EXPECT_NEAR(weight, 1.0, 1e-13);
      }
    }
  }
}

TEST(ProjectedReduce, CommutesWithChangesOfTheFrame) {
  RandomStream stream(8);
  const auto mixture = random_mixture<SO3d>(stream, 8, 0.4, 0.1);
  const SO3d turn = SO3d::exp({1.0, -0.4, 0.7});
  std::vector<Component<Rotation>> turned;
  for (const auto& c : mixture.components()) {
    turned.push_back(
        {c.log_weight,
         {turn * c.density.tangent_point(), c.density.tangent_mean(), c.density.covariance()}});
  }
  for (const MergeRule rule : kProjectedMergeRules) {
    const ReductionSettings settings{
        .max_components = 3, .pair = PairRule::weighted_symmetric_kl, .merge = {.rule = rule}};
    const auto a = reduce(mixture, settings).mixture;
    const auto b = reduce(Mixture<Rotation>(turned), settings).mixture;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NEAR(a.weight(i), b.weight(i), 1e-12);
      EXPECT_TRUE((turn * a[i].density.mean()).is_approx(b[i].density.mean(), 1e-9));
      EXPECT_LT(testing::relative_difference(b[i].density.covariance(), a[i].density.covariance()),
                1e-8);
    }
  }
}

TEST(ProjectedReduce, DistancesAreBetweenModes) {
  const Rotation a = isotropic(0.2, 0.1);
  const Rotation b = isotropic(0.9, 0.2);
  EXPECT_NEAR(distance(a, b, DistanceMetric::tangent_norm), 0.7, 1e-14);
  EXPECT_NEAR(distance(a, b, DistanceMetric::rotation), 0.7, 1e-14);
  EXPECT_NEAR(distance(a, b, DistanceMetric::mahalanobis), mahalanobis_distance(a, b), 1e-14);
  EXPECT_NEAR(weighted_symmetric_kl<Rotation>({std::log(0.2), a}, {std::log(0.3), b}),
              0.12 * gaussian_symmetric_kl(a, b), 1e-12);
}

}  // namespace
}  // namespace posemix
