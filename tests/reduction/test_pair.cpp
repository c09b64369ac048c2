// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/reduction/pair.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "posemix/base/random.hpp"
#include "posemix/reduction/merge.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using Line = ConcentratedGaussian<Rnd<1>>;
using Posed = ConcentratedGaussian<SE3d>;
using Pair = std::pair<std::size_t, std::size_t>;

constexpr std::array kPairRules{PairRule::largest_with_smallest, PairRule::most_distant,
                                PairRule::runnalls, PairRule::symmetric_kl,
                                PairRule::weighted_symmetric_kl};

Component<Line> on_axis(double weight, double mean, double variance = 1.0) {
  using Scalar1 = Eigen::Matrix<double, 1, 1>;
  return {std::log(weight), {Rnd<1>(Scalar1(mean)), Scalar1(variance)}};
}

template <LieGroup G>
Pair next(const std::vector<Component<ConcentratedGaussian<G>>>& components, PairRule rule,
          DistanceMetric metric = DistanceMetric::tangent_norm) {
  return PairSelector<ConcentratedGaussian<G>>(components, rule, metric).next(components);
}

TEST(PairSelector, LargestWithSmallestGoesByWeight) {
  using R1 = Rnd<1>;
  const auto rule = PairRule::largest_with_smallest;
  EXPECT_EQ(next<R1>({on_axis(0.2, 0), on_axis(0.5, 9), on_axis(0.1, 8), on_axis(0.2, 7)}, rule),
            Pair(1, 2));
  EXPECT_EQ(next<R1>({on_axis(0.1, 0), on_axis(0.2, 9), on_axis(0.7, 8)}, rule), Pair(0, 2));
  // The first largest and the last smallest of equals.
  EXPECT_EQ(next<R1>({on_axis(0.1, 0), on_axis(0.4, 9), on_axis(0.4, 8), on_axis(0.1, 0)}, rule),
            Pair(1, 3));
  EXPECT_EQ(next<R1>({on_axis(1, 0), on_axis(1, 9), on_axis(1, 8)}, rule), Pair(0, 2));
  EXPECT_EQ(next<R1>({on_axis(1, 0), on_axis(0, 9), on_axis(0, 8)}, rule), Pair(0, 2));
}

TEST(PairSelector, MostDistantGoesByTheMeans) {
  using R1 = Rnd<1>;
  EXPECT_EQ(next<R1>({on_axis(0.2, 1), on_axis(0.5, -3), on_axis(0.1, 2), on_axis(0.2, 1.5)},
                     PairRule::most_distant),
            Pair(1, 2));
}

TEST(PairSelector, SymmetricKlTakesTheMostAlikeWhateverTheWeights) {
  using R1 = Rnd<1>;
  // Symmetric KL: 0 and 1 differ by 0.1^2 = 0.01; 2 and 3 share the mean but not the variance,
  // (9 + 1/9 - 2) / 2 = 3.6.
  EXPECT_EQ(next<R1>({on_axis(0.5, 0), on_axis(0.4, 0.1), on_axis(1e-6, 5), on_axis(1e-6, 5, 9)},
                     PairRule::symmetric_kl),
            Pair(0, 1));
}

TEST(PairSelector, RunnallsPrefersPairsOfLittleWeight) {
  using R1 = Rnd<1>;
  // The same components: merging the two light ones costs about 1e-6, the heavy ones about
  // 0.45 log(1 + 0.0025) = 1e-3.
  EXPECT_EQ(next<R1>({on_axis(0.5, 0), on_axis(0.4, 0.1), on_axis(1e-6, 5), on_axis(1e-6, 5, 9)},
                     PairRule::runnalls),
            Pair(2, 3));
}

TEST(PairSelector, WeightedSymmetricKlPrefersPairsOfLittleWeight) {
  using R1 = Rnd<1>;
  // The same components: 0.5 0.4 / 0.9 0.01 = 2.2e-3 against 0.5e-6 3.6.
  EXPECT_EQ(next<R1>({on_axis(0.5, 0), on_axis(0.4, 0.1), on_axis(1e-6, 5), on_axis(1e-6, 5, 9)},
                     PairRule::weighted_symmetric_kl),
            Pair(2, 3));
  EXPECT_NEAR(weighted_symmetric_kl(on_axis(0.5, 0), on_axis(0.4, 0.1)), 0.002 / 0.9, 1e-15);
  EXPECT_EQ(weighted_symmetric_kl(on_axis(0.5, 0), on_axis(0.0, 0.1)), 0.0);
}

TEST(PairSelector, TiesGoToThePairFoundFirst) {
  using R1 = Rnd<1>;
  const std::vector same{on_axis(0.2, 1), on_axis(0.5, 1), on_axis(0.3, 1), on_axis(0.1, 1)};
  EXPECT_EQ(next<R1>(same, PairRule::most_distant), Pair(0, 1));
  EXPECT_EQ(next<R1>(same, PairRule::symmetric_kl), Pair(0, 1));
  // 0-2 and 1-2 are equally far apart.
  EXPECT_EQ(next<R1>({on_axis(1, 0), on_axis(1, 0), on_axis(1, 4)}, PairRule::most_distant),
            Pair(0, 2));
}

/// A pose with the given logarithm and standard deviations.
Component<Posed> pose(const Vector6d& log_mean, const Vector6d& deviations = Vector6d::Ones()) {
  return {0.0, {SE3d::exp(log_mean), deviations.cwiseAbs2().asDiagonal()}};
}

TEST(Distance, ReadsTheNamedCoordinates) {
  Vector6d coordinates;
  coordinates << 0.3, 0.0, -0.4, 1.0, 2.0, 2.0;
  const auto at_origin = pose(Vector6d::Zero()).density;
  const auto other = pose(coordinates, Vector6d::Constant(2.0)).density;
  EXPECT_NEAR(distance(at_origin, other, DistanceMetric::rotation), 0.5, 1e-14);
  EXPECT_NEAR(distance(at_origin, other, DistanceMetric::translation), 3.0, 1e-14);
  EXPECT_NEAR(distance(at_origin, other, DistanceMetric::tangent_norm), std::sqrt(9.25), 1e-14);
  // Covariances I and 4 I: |d| / sqrt(5).
  EXPECT_NEAR(distance(at_origin, other, DistanceMetric::mahalanobis), std::sqrt(9.25 / 5.0),
              1e-14);
  // Of poses without a turn between them.
  const ConcentratedGaussian<SE3d> beside(SE3d(SO3d(), {0.0, 2.0, 0.0}), at_origin.covariance());
  EXPECT_EQ(distance(at_origin, beside, DistanceMetric::rotation), 0.0);
  EXPECT_EQ(distance(at_origin, beside, DistanceMetric::tangent_norm), 2.0);
}

TEST(Distance, SumsOverThePosesOfAStack) {
  PoseStackd::Tangent d = PoseStackd::Tangent::Zero(12);
  d << 0.3, 0, 0, 2, 0, 0, 0, 0.4, 0, 0, 1, 2;
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(12, 12);
  const ConcentratedGaussian<PoseStackd> a(PoseStackd(2), covariance);
  const ConcentratedGaussian<PoseStackd> b(PoseStackd::exp(d), covariance);
  EXPECT_NEAR(distance(a, b, DistanceMetric::rotation), 0.5, 1e-14);
  EXPECT_NEAR(distance(a, b, DistanceMetric::translation), 3.0, 1e-14);
  EXPECT_NEAR(distance(a, b, DistanceMetric::mahalanobis), std::sqrt(9.25 / 2.0), 1e-14);
}

TEST(Distance, IsTheTangentNormWhereThereAreNoPoses) {
  const ConcentratedGaussian<SO3d> a(SO3d(), Eigen::Matrix3d::Identity());
  const ConcentratedGaussian<SO3d> b(SO3d::exp({0.6, 0, 0.8}), Eigen::Matrix3d::Identity());
  EXPECT_NEAR(distance(a, b, DistanceMetric::rotation), 1.0, 1e-14);
  EXPECT_NEAR(distance(a, b, DistanceMetric::translation), 1.0, 1e-14);
  EXPECT_EQ(testing::thrown_message([&] { distance(a, b, static_cast<DistanceMetric>(9)); }),
            "distance: unknown metric");
}

TEST(PairSelector, TheMetricDecidesWhatIsDistant) {
  const auto turned = pose((Vector6d() << 0.5, 0, 0, 0, 0, 0).finished());
  const auto moved = pose((Vector6d() << 0, 0, 0, 0.8, 0, 0).finished());
  Vector6d certain = Vector6d::Ones();
  certain[5] = 0.01;
  const auto surely_moved = pose((Vector6d() << 0, 0, 0, 0, 0, 0.3).finished(), certain);
  const auto origin = pose(Vector6d::Zero(), certain);
  const std::vector components{origin, turned, moved, surely_moved};
  const auto most_distant = [&](DistanceMetric metric) {
    return next<SE3d>(components, PairRule::most_distant, metric);
  };
  EXPECT_EQ(most_distant(DistanceMetric::rotation), Pair(0, 1));
  EXPECT_EQ(most_distant(DistanceMetric::translation), Pair(2, 3));
  EXPECT_EQ(most_distant(DistanceMetric::tangent_norm), Pair(1, 2));
  EXPECT_EQ(most_distant(DistanceMetric::mahalanobis), Pair(0, 3));
}

TEST(PairSelector, RejectsAnUnknownRule) {
  const std::vector components{on_axis(1, 0), on_axis(1, 1)};
  EXPECT_EQ(testing::thrown_message([&] { next<Rnd<1>>(components, static_cast<PairRule>(9)); }),
            "reduce: unknown pair rule");
}

/// The best pair by trying all, with the cost straight from its definition.
template <LieGroup G>
double cost(const Component<ConcentratedGaussian<G>>& a,
            const Component<ConcentratedGaussian<G>>& b, PairRule rule) {
  switch (rule) {
    case PairRule::most_distant:
      return -(b.density.mean() * a.density.mean().inverse()).log().norm();
    case PairRule::runnalls:
      return runnalls_bound(a, b);
    case PairRule::weighted_symmetric_kl:
      return (gaussian_kl(a.density, b.density) + gaussian_kl(b.density, a.density)) /
             (std::exp(-a.log_weight) + std::exp(-b.log_weight));
    default:
      return gaussian_kl(a.density, b.density) + gaussian_kl(b.density, a.density);
  }
}

template <class G>
class PairSelectorOn : public ::testing::Test {};
using PairGroups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(PairSelectorOn, PairGroups);

TYPED_TEST(PairSelectorOn, CachedCostsAreThoseOfAFreshStart) {
  testing::check_property([] {
    using G = TypeParam;
    for (const PairRule rule : kPairRules) {
      auto components = testing::draw_components<G>(6, 0.4, 0.2);
      PairSelector<ConcentratedGaussian<G>> selector(components, rule,
                                                     DistanceMetric::tangent_norm);
      while (components.size() > 2) {
        const auto [a, b] = selector.next(components);
        RC_ASSERT(a < b && b < components.size());
        RC_ASSERT(Pair(a, b) == next<G>(components, rule));
        const std::vector pair{components[a], components[b]};
        components[a] = merge<G>(pair).component;
        components.erase(components.begin() + static_cast<std::ptrdiff_t>(b));
        selector.merged(components, a, b);
      }
      RC_ASSERT(selector.next(components) == Pair(0, 1));
    }
  });
}

TYPED_TEST(PairSelectorOn, NoPairIsCheaperThanTheChosen) {
  testing::check_property([] {
    using G = TypeParam;
    const auto components = testing::draw_components<G>(5, 0.4, 0.2);
    for (const PairRule rule : {PairRule::most_distant, PairRule::runnalls, PairRule::symmetric_kl,
                                PairRule::weighted_symmetric_kl}) {
      const auto [a, b] = next<G>(components, rule);
      const double chosen = cost(components[a], components[b], rule);
      for (std::size_t i = 0; i < components.size(); ++i) {
        for (std::size_t j = i + 1; j < components.size(); ++j) {
          const double other = cost(components[i], components[j], rule);
          RC_ASSERT(chosen <= other + 1e-10 * (1.0 + std::abs(other)));
        }
      }
    }
  });
}

/// A mixture with clusters, light and heavy components.
std::vector<Component<Posed>> clusters(std::size_t count) {
  RandomStream stream(17);
  std::vector<Component<Posed>> components;
  for (std::size_t i = 0; i < count; ++i) {
    Vector6d centre = Vector6d::Zero();
    centre[2] = static_cast<double>(i % 3);
    Matrix6d root;
    for (double& x : root.reshaped()) x = 0.1 * stream.normal();
    Vector6d step;
    for (double& x : step) x = (i % 5 == 0 ? 1.0 : 0.1) * stream.normal();
    const SE3d mean = SE3d::exp(step) * SE3d::exp(centre);
    components.push_back(
        {stream.normal(), Posed(mean, root * root.transpose() + 1e-3 * Matrix6d::Identity())});
  }
  return components;
}

double cost_of(const Component<Posed>& a, const Component<Posed>& b, PairRule rule,
               DistanceMetric metric) {
  switch (rule) {
    case PairRule::runnalls:
      return runnalls_bound(a, b);
    case PairRule::symmetric_kl:
      return gaussian_symmetric_kl(a.density, b.density);
    case PairRule::weighted_symmetric_kl:
      return weighted_symmetric_kl(a, b);
    default:
      return -distance(a.density, b.density, metric);
  }
}

constexpr std::array kMetrics{DistanceMetric::tangent_norm, DistanceMetric::rotation,
                              DistanceMetric::translation, DistanceMetric::mahalanobis};

TEST(PairSelector, CostsByVectorInstructionsAreThoseOfTheFunctions) {
  internal::by_every_instruction_set([] {
    const std::vector<Component<Posed>> components = clusters(21);
    internal::ComponentColumns columns(components.size());
    for (std::size_t i = 0; i < components.size(); ++i) columns.set(i, components[i]);
    std::vector<double> costs(components.size() + internal::ComponentColumns::kRoom);
    for (const PairRule rule : kPairRules) {
      if (rule == PairRule::largest_with_smallest) continue;
      for (const DistanceMetric metric : kMetrics) {
        columns.costs(rule, metric, 4, components.size(), costs.data());
        for (std::size_t i = 0; i < components.size(); ++i) {
          if (i == 4) continue;
          const double expected = cost_of(components[i], components[4], rule, metric);
          EXPECT_NEAR(costs[i], expected, 1e-12 * (1.0 + std::abs(expected)))
              << word_of(rule) << " " << i;
        }
      }
    }
  });
}

TEST(PairSelector, AComponentWithoutWeightCostsNothingByAnyInstructions) {
  internal::by_every_instruction_set([] {
    std::vector<Component<Posed>> components = clusters(9);
    components[2].log_weight = -std::numeric_limits<double>::infinity();
    internal::ComponentColumns columns(components.size());
    for (std::size_t i = 0; i < components.size(); ++i) columns.set(i, components[i]);
    std::vector<double> costs(components.size() + internal::ComponentColumns::kRoom);
    for (const PairRule rule : {PairRule::runnalls, PairRule::weighted_symmetric_kl}) {
      columns.costs(rule, {}, 2, components.size(), costs.data());
      for (std::size_t i = 0; i < components.size(); ++i) EXPECT_EQ(costs[i], 0.0) << i;
      columns.costs(rule, {}, 4, components.size(), costs.data());
      EXPECT_EQ(costs[2], 0.0);
    }
  });
}

TEST(PairSelector, WhereRoundingLeavesNoFactorADivergenceIsInfinite) {
  const Component<Posed> wide{0.0, Posed(SE3d(), 1e10 * Matrix6d::Identity())};
  const Component<Posed> narrow{0.0,
                                Posed(SE3d(SO3d(), {1e4, 0.0, 0.0}), 1e-10 * Matrix6d::Identity())};
  internal::ComponentColumns columns(2);
  columns.set(0, wide);
  columns.set(1, narrow);
  std::vector<double> costs(2 + internal::ComponentColumns::kRoom);
  columns.costs(PairRule::symmetric_kl, {}, 1, 1, costs.data());
  EXPECT_GT(costs[0], 1e10);
}

TEST(PairSelector, FindsTheLeastPairThroughAllMerges) {
  // Oracle: all pairs anew after every merge.
  for (const PairRule rule : kPairRules) {
    if (rule == PairRule::largest_with_smallest) continue;
    std::vector<Component<Posed>> components = clusters(40);
    const auto metric = DistanceMetric::tangent_norm;
    PairSelector<Posed> selector(components, rule, metric);
    while (components.size() > 2) {
      Pair least{0, 1};
      for (std::size_t a = 0; a < components.size(); ++a) {
        for (std::size_t b = a + 1; b < components.size(); ++b) {
          if (cost_of(components[b], components[a], rule, metric) <
              cost_of(components[least.second], components[least.first], rule, metric))
            least = {a, b};
        }
      }
      const auto [a, b] = selector.next(components);
      ASSERT_EQ(Pair(a, b), least) << word_of(rule) << ", " << components.size() << " left";
      const Component<Posed>* const two[] = {&components[a], &components[b]};
      components[a] = merge<SE3d>(std::span<const Component<Posed>* const>(two)).component;
      components.erase(components.begin() + static_cast<std::ptrdiff_t>(b));
      selector.merged(components, a, b);
    }
  }
}

}  // namespace
}  // namespace posemix
