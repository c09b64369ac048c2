// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "posemix/divergence/wasserstein.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::draw_components;
using testing::draw_gaussian;

using Line = ConcentratedGaussian<Rnd<1>>;

Line line(double mean, double deviation) {
  using One = Eigen::Matrix<double, 1, 1>;
  return {Rnd<1>(One(mean)), One(deviation * deviation)};
}

template <class G>
class WassersteinOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(WassersteinOn, Groups);

TEST(MixtureWasserstein, RefusesDistancesThatNoNumberHolds) {
  const Mixture<ConcentratedGaussian<Rnd<1>>> near({{0.0, line(0.0, 1.0)}, {0.0, line(1.0, 1.0)}});
  const Mixture<ConcentratedGaussian<Rnd<1>>> far({{0.0, line(0.0, 1.0)}, {0.0, line(1e152, 1.0)}});
  EXPECT_NE(testing::thrown_message([&] {
              mixture_wasserstein(near, far);
            }).find("components are 1e+304 apart, squared"),
            std::string::npos);
}

TEST(GaussianWasserstein, ByHandOnTheLine) {
  EXPECT_NEAR(gaussian_wasserstein(line(1.0, 2.0), line(4.0, 6.0)), 5.0, 1e-14);
}

TEST(GaussianWasserstein, IsTheTextbookFormulaOnVectors) {
  check_property([] {
    const auto p = draw_gaussian<Rnd<3>>(1.0, 0.5);
    const auto q = draw_gaussian<Rnd<3>>(1.0, 0.5);
    const auto root = [](const Eigen::Matrix3d& m) -> Eigen::Matrix3d {
      return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m).operatorSqrt();
    };
    const Eigen::Matrix3d half = root(p.covariance());
    const Eigen::Matrix3d cross = root(half * q.covariance() * half);
    const double squared = (p.mean().value() - q.mean().value()).squaredNorm() +
                           (p.covariance() + q.covariance() - 2.0 * cross).trace();
    RC_ASSERT(std::abs(std::pow(gaussian_wasserstein(p, q), 2) - squared) < 1e-10);
  });
}

TYPED_TEST(WassersteinOn, IsADistanceOnCloseDensities) {
  check_property([] {
    const auto p = draw_gaussian<TypeParam>(0.5, 0.3);
    const auto q = draw_gaussian<TypeParam>(0.5, 0.3);
    RC_ASSERT(gaussian_wasserstein(p, p) < 1e-12);
    RC_ASSERT(std::abs(gaussian_wasserstein(p, q) - gaussian_wasserstein(q, p)) < 1e-8);
    const ConcentratedGaussian<TypeParam> wider(p.mean(), 1.0001 * p.covariance());
    const double expected = (std::sqrt(1.0001) - 1.0) * std::sqrt(p.covariance().trace());
    RC_ASSERT(std::abs(gaussian_wasserstein(p, wider) / expected - 1.0) < 1e-9);
  });
}

TEST(GaussianWasserstein, WeighsRadiansByTheLengthScale) {
  const Matrix6d covariance = 0.01 * Matrix6d::Identity();
  const ConcentratedGaussian<SE3d> p(SE3d(), covariance);
  Vector6d turn = Vector6d::Zero();
  turn[2] = 0.2;
  Vector6d shift = Vector6d::Zero();
  shift[4] = 0.2;
  EXPECT_NEAR(
      gaussian_wasserstein(p, ConcentratedGaussian<SE3d>(SE3d::exp(shift), covariance), 3.0), 0.2,
      1e-3);
  const ConcentratedGaussian<SE3d> narrow(SE3d(), 1e-12 * Matrix6d::Identity());
  const ConcentratedGaussian<SE3d> turned(SE3d::exp(turn), 1e-12 * Matrix6d::Identity());
  EXPECT_NEAR(gaussian_wasserstein(narrow, turned, 3.0), 0.6, 1e-6);
  const ConcentratedGaussian<SO3d> a(SO3d(), 1e-12 * Eigen::Matrix3d::Identity());
  const ConcentratedGaussian<SO3d> b(SO3d::exp({0, 0, 0.2}), a.covariance());
  EXPECT_NEAR(gaussian_wasserstein(a, b, 2.0), 0.4, 1e-6);
  Eigen::VectorXd second = Eigen::VectorXd::Zero(12);
  second[8] = 0.2;
  const PoseStackd::TangentMatrix tiny = 1e-12 * PoseStackd::TangentMatrix::Identity(12, 12);
  EXPECT_NEAR(
      gaussian_wasserstein(ConcentratedGaussian<PoseStackd>(PoseStackd::exp(0.0 * second), tiny),
                           ConcentratedGaussian<PoseStackd>(PoseStackd::exp(second), tiny), 3.0),
      0.6, 1e-6);
}

TEST(MixtureWasserstein, OnTheLineIsTheSortedMatching) {
  // Equal widths: components move in the order of their means; the weights split.
  const Mixture<Line> p({{std::log(0.5), line(0.0, 1.0)}, {std::log(0.5), line(10.0, 1.0)}});
  const Mixture<Line> q({{std::log(0.25), line(11.0, 1.0)}, {std::log(0.75), line(2.0, 1.0)}});
  // 0.5 moves by 2, 0.25 by 8 (from 10 to 2), 0.25 by 1.
  EXPECT_NEAR(mixture_wasserstein(p, q), std::sqrt(0.5 * 4 + 0.25 * 64 + 0.25 * 1), 1e-10);
  EXPECT_NEAR(mixture_wasserstein(q, p), mixture_wasserstein(p, q), 1e-10);
}

TYPED_TEST(WassersteinOn, MixtureOfEqualWeightsIsTheBestPermutation) {
  check_property([] {
    const std::size_t n = *rc::gen::inRange<std::size_t>(1, 6);
    auto a = draw_components<TypeParam>(n, 0.4, 0.2);
    auto b = draw_components<TypeParam>(n, 0.4, 0.2);
    for (auto& c : a) c.log_weight = 0.0;
    for (auto& c : b) c.log_weight = 0.0;
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    double best = std::numeric_limits<double>::infinity();
    do {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        sum += std::pow(gaussian_wasserstein(a[i].density, b[order[i]].density, 0.5), 2);
      }
      best = std::min(best, sum / static_cast<double>(n));
    } while (std::ranges::next_permutation(order).found);
    using Mixtures = Mixture<ConcentratedGaussian<TypeParam>>;
    RC_ASSERT(std::abs(mixture_wasserstein(Mixtures(a), Mixtures(b), 0.5) - std::sqrt(best)) <
              1e-9 * (1.0 + std::sqrt(best)));
  });
}

TYPED_TEST(WassersteinOn, MixtureDistanceOfAMixtureFromItselfIsZero) {
  check_property([] {
    auto components = draw_components<TypeParam>(4, 0.4, 0.2);
    using Mixtures = Mixture<ConcentratedGaussian<TypeParam>>;
    const Mixtures p(components);
    std::ranges::reverse(components);
    RC_ASSERT(mixture_wasserstein(p, Mixtures(components)) < 2e-6);
    RC_ASSERT(mixture_wasserstein(p, p) < 1e-12);
    const Mixtures one({components[0]});
    double expected = 0.0;
    for (const auto& c : p.components()) {
      expected += std::exp(c.log_weight) *
                  std::pow(gaussian_wasserstein(c.density, components[0].density), 2);
    }
    RC_ASSERT(std::abs(mixture_wasserstein(p, one) - std::sqrt(expected)) < 1e-9);
  });
}

TEST(MixtureWasserstein, ManyWeightedComponents) {
  // On the line the optimal plan of equal widths is monotone, for any weights.
  RandomStream stream(3);
  std::vector<std::pair<double, double>> a;
  std::vector<std::pair<double, double>> b;
  const auto draw = [&](auto& points, std::size_t count) {
    std::vector<Component<Line>> components;
    double total = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      points.emplace_back(stream.normal(), 0.01 + stream.uniform());
      components.push_back({std::log(points.back().second), line(points.back().first, 0.3)});
      total += points.back().second;
    }
    for (auto& point : points) point.second /= total;
    std::ranges::sort(points);
    return Mixture<Line>(components);
  };
  const Mixture<Line> p = draw(a, 40);
  const Mixture<Line> q = draw(b, 30);
  double sum = 0.0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const double moved = std::min(a[i].second, b[j].second);
    sum += moved * std::pow(a[i].first - b[j].first, 2);
    a[i].second -= moved;
    b[j].second -= moved;
    if (a[i].second <= 0.0) ++i;
    if (j < b.size() && b[j].second <= 0.0) ++j;
  }
  EXPECT_NEAR(mixture_wasserstein(p, q), std::sqrt(sum), 1e-9);
}

TEST(MixtureWasserstein, RejectsBadInput) {
  const auto p = line(0.0, 1.0);
  EXPECT_THROW(gaussian_wasserstein(p, p, 0.0), InvalidInput);
  const ConcentratedGaussian<Rnd<Eigen::Dynamic>> two(Rnd<Eigen::Dynamic>(Eigen::VectorXd::Zero(2)),
                                                      Eigen::MatrixXd::Identity(2, 2));
  const ConcentratedGaussian<Rnd<Eigen::Dynamic>> three(
      Rnd<Eigen::Dynamic>(Eigen::VectorXd::Zero(3)), Eigen::MatrixXd::Identity(3, 3));
  EXPECT_THROW(gaussian_wasserstein(two, three), InvalidInput);
}

}  // namespace
}  // namespace posemix
