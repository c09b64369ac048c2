// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "posemix/divergence/gaussian.hpp"
#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/rotation_quadrature.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::draw_components;
using testing::draw_gaussian;

constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

template <class G>
class DivergenceOn : public ::testing::Test {};
using Groups = ::testing::Types<SO3d, SE3d, PoseStackd, Rnd<3>>;
TYPED_TEST_SUITE(DivergenceOn, Groups);

TEST(GaussianKl, ByHandOnTheLine) {
  // D(N(1, 4) || N(3, 9)) = (4/9 + 2^2/9 - 1 + log(9/4)) / 2 = (log(9/4) - 1/9) / 2.
  using Scalar1 = Eigen::Matrix<double, 1, 1>;
  const ConcentratedGaussian<Rnd<1>> p(Rnd<1>(Scalar1(1.0)), Scalar1(4.0));
  const ConcentratedGaussian<Rnd<1>> q(Rnd<1>(Scalar1(3.0)), Scalar1(9.0));
  EXPECT_NEAR(gaussian_kl(p, q), 0.5 * (std::log(9.0 / 4.0) - 1.0 / 9.0), 1e-14);
  // D(q || p) = (9/4 + 4/4 - 1 + log(4/9)) / 2.
  EXPECT_NEAR(gaussian_kl(q, p), 0.5 * (2.25 + std::log(4.0 / 9.0)), 1e-14);
}

TEST(GaussianKl, IsTheClosedFormOnVectors) {
  check_property([] {
    const auto p = draw_gaussian<Rnd<3>>(1.0, 0.5);
    const auto q = draw_gaussian<Rnd<3>>(1.0, 0.5);
    const Eigen::Matrix3d information = q.covariance().inverse();
    const Eigen::Vector3d d = q.mean().value() - p.mean().value();
    const double expected =
        0.5 * ((information * p.covariance()).trace() + d.dot(information * d) - 3.0 +
               std::log(q.covariance().determinant() / p.covariance().determinant()));
    RC_ASSERT(std::abs(gaussian_kl(p, q) - expected) < 1e-11 * (1.0 + expected));
  });
}

TYPED_TEST(DivergenceOn, KlIsZeroOnlyForTheSameDensity) {
  check_property([] {
    using G = TypeParam;
    const auto p = draw_gaussian<G>(0.5, 0.3);
    const auto q = draw_gaussian<G>(0.5, 0.3);
    RC_ASSERT(std::abs(gaussian_kl(p, p)) < 1e-12);
    RC_ASSERT(std::abs(gaussian_symmetric_kl(p, p)) < 1e-12);
    const ConcentratedGaussian<G> wider(p.mean(), 1.1 * p.covariance());
    const ConcentratedGaussian<G> moved(G::exp(G::Tangent::Constant(p.dof(), 0.01)) * p.mean(),
                                        p.covariance());
    RC_ASSERT(gaussian_kl(p, wider) > 1e-3);
    RC_ASSERT(gaussian_kl(p, moved) > 1e-6);
    RC_ASSERT(gaussian_kl(p, q) > -1e-12);
  });
}

TYPED_TEST(DivergenceOn, SymmetricKlIsTheSumOfBothAndSymmetric) {
  check_property([] {
    const auto p = draw_gaussian<TypeParam>(0.5, 0.3);
    const auto q = draw_gaussian<TypeParam>(0.5, 0.3);
    const double symmetric = gaussian_symmetric_kl(p, q);
    RC_ASSERT(std::abs(symmetric - gaussian_kl(p, q) - gaussian_kl(q, p)) <
              1e-12 * (1 + symmetric));
    RC_ASSERT(std::abs(symmetric - gaussian_symmetric_kl(q, p)) < 1e-9 * (1 + symmetric));
  });
}

/// Shifts both means on the left and on the right: the same densities in other frames.
template <class G>
ConcentratedGaussian<G> moved(const G& left, const ConcentratedGaussian<G>& density,
                              const G& right) {
  return {left * density.mean() * right, left.adjoint_congruence(density.covariance())};
}

TYPED_TEST(DivergenceOn, FramesDoNotMatter) {
  check_property([] {
    using G = TypeParam;
    const auto components = draw_components<G>(2, 0.3, 0.3);
    const G left = testing::draw_near_identity<G>(1.0);
    const G right = testing::draw_near_identity<G>(1.0);
    auto in_other_frames = components;
    for (auto& c : in_other_frames) c.density = moved(left, c.density, right);
    const double kl = gaussian_kl(components[0].density, components[1].density);
    const double bound = runnalls_bound(components[0], components[1]);
    RC_ASSERT(std::abs(gaussian_kl(in_other_frames[0].density, in_other_frames[1].density) - kl) <
              1e-8 * (1.0 + kl));
    RC_ASSERT(std::abs(runnalls_bound(in_other_frames[0], in_other_frames[1]) - bound) <
              1e-8 * (1.0 + bound));
  });
}

TEST(GaussianKl, OnRotationsAgreesWithQuadrature) {
  Eigen::Matrix3d p_covariance;
  p_covariance << 1.0, 0.3, -0.1, 0.3, 0.6, 0.2, -0.1, 0.2, 0.8;
  const Eigen::Matrix3d q_covariance = Eigen::Vector3d(0.8, 1.1, 1.5).asDiagonal();
  const auto error = [&](double scale) {
    const SO3d mean = SO3d::exp({0.3, -1.0, 0.7});
    const SO3d other = SO3d::exp(scale * Eigen::Vector3d(0.6, -0.4, 0.7)) * mean;
    const ConcentratedGaussian<SO3d> p(mean, scale * scale * p_covariance);
    const ConcentratedGaussian<SO3d> q(other, scale * scale * q_covariance);
    const ConcentratedGaussian<SO3d>::Evaluator log_p(p);
    const ConcentratedGaussian<SO3d>::Evaluator log_q(q);
    const testing::BallRule rule{
        .radius = std::min(3.0, 9.0 * scale), .radial_panels = 3, .azimuths = 80};
    const double exact = rule.integrate(mean, [&](const SO3d& x) {
      const double log_density = log_p.log_density(x);
      return std::exp(log_density) * (log_density - log_q.log_density(x));
    });
    return gaussian_kl(p, q) / exact - 1.0;
  };
  EXPECT_LT(std::abs(error(0.2)), 0.02);
  // First order: the error falls with the square of deviations and distance.
  EXPECT_NEAR(error(0.2) / error(0.1), 4.0, 0.5);
}

TEST(RunnallsBound, IsTheTextbookFormulaOnVectors) {
  check_property([] {
    const auto c = draw_components<Rnd<3>>(2, 1.0, 0.5);
    const double w_a = std::exp(c[0].log_weight);
    const double w_b = std::exp(c[1].log_weight);
    const Eigen::Vector3d d = c[0].density.mean().value() - c[1].density.mean().value();
    const Eigen::Matrix3d merged =
        (w_a * c[0].density.covariance() + w_b * c[1].density.covariance()) / (w_a + w_b) +
        w_a * w_b / ((w_a + w_b) * (w_a + w_b)) * d * d.transpose();
    const double expected = 0.5 * ((w_a + w_b) * std::log(merged.determinant()) -
                                   w_a * std::log(c[0].density.covariance().determinant()) -
                                   w_b * std::log(c[1].density.covariance().determinant()));
    RC_ASSERT(std::abs(runnalls_bound(c[0], c[1]) - expected) < 1e-11 * (1.0 + expected));
  });
}

TYPED_TEST(DivergenceOn, RunnallsBoundOfIdenticalComponentsIsZero) {
  check_property([] {
    const auto components = draw_components<TypeParam>(2, 0.3, 0.3);
    const Component<ConcentratedGaussian<TypeParam>> twin{components[1].log_weight,
                                                          components[0].density};
    RC_ASSERT(std::abs(runnalls_bound(components[0], twin)) < 1e-11);
    RC_ASSERT(runnalls_bound(components[0], components[1]) > -1e-12);
    auto other = twin;
    const TypeParam step = TypeParam::exp(TypeParam::Tangent::Constant(twin.density.dof(), 0.01));
    other.density = {step * twin.density.mean(), twin.density.covariance()};
    RC_ASSERT(runnalls_bound(components[0], other) > 1e-9);
  });
}

TYPED_TEST(DivergenceOn, RunnallsBoundIsSymmetricAndProportionalToTheWeights) {
  check_property([] {
    const auto c = draw_components<TypeParam>(2, 0.3, 0.3);
    const double bound = runnalls_bound(c[0], c[1]);
    RC_ASSERT(std::abs(runnalls_bound(c[1], c[0]) - bound) < 1e-9 * (1.0 + bound));
    auto heavier = c;
    for (auto& component : heavier) component.log_weight += std::log(3.0);
    RC_ASSERT(std::abs(runnalls_bound(heavier[0], heavier[1]) - 3.0 * bound) <
              1e-9 * (1.0 + bound));
  });
}

TEST(RunnallsBound, OfWeightlessComponentsIsZero) {
  const ConcentratedGaussian<SO3d> density(SO3d(), Eigen::Matrix3d::Identity());
  const ConcentratedGaussian<SO3d> other(SO3d::exp({1, 0, 0}), 0.1 * Eigen::Matrix3d::Identity());
  EXPECT_EQ(runnalls_bound<SO3d>({kMinusInfinity, density}, {kMinusInfinity, other}), 0.0);
  EXPECT_NEAR(runnalls_bound<SO3d>({0.0, density}, {kMinusInfinity, other}), 0.0, 1e-12);
  EXPECT_NEAR(runnalls_bound<SO3d>({kMinusInfinity, density}, {0.0, other}), 0.0, 1e-12);
}

TEST(RunnallsBound, BoundsTheDivergenceThatAMergeCauses) {
  using D = ConcentratedGaussian<Rnd<2>>;
  const auto at = [](double x, double y) { return Rnd<2>(Eigen::Vector2d(x, y)); };
  const Eigen::Matrix2d p = Eigen::Vector2d(0.5, 0.2).asDiagonal();
  const Component<D> a{std::log(0.3), D(at(0, 0), p)};
  const Component<D> b{std::log(0.3), D(at(1.5, 0.5), 0.5 * p)};
  const Component<D> c{std::log(0.4), D(at(0.5, -1), 2.0 * p)};
  // Equal weights: mean (a + b) / 2, covariance (P_a + P_b) / 2 + d d^T / 4.
  const Eigen::Vector2d d(1.5, 0.5);
  const Eigen::Matrix2d merged = 0.75 * p + 0.25 * d * d.transpose();
  const Mixture<D> before({a, b, c});
  const Mixture<D> after({{std::log(0.6), D(at(0.75, 0.25), merged)}, c});
  const Mixture<D>::Evaluator log_before(before);
  const Mixture<D>::Evaluator log_after(after);
  // D(before || after) by a product rule.
  const auto nodes_x = testing::gauss_legendre(-8.0, 9.0, 4);
  const auto nodes_y = testing::gauss_legendre(-7.0, 6.0, 4);
  double divergence = 0.0;
  for (const auto& x : nodes_x) {
    for (const auto& y : nodes_y) {
      const double log_p = log_before.log_density(at(x.at, y.at));
      divergence +=
          x.weight * y.weight * std::exp(log_p) * (log_p - log_after.log_density(at(x.at, y.at)));
    }
  }
  EXPECT_GT(divergence, 0.01);
  EXPECT_GT(runnalls_bound(a, b), divergence);
  EXPECT_LT(runnalls_bound(a, b), 10.0 * divergence);
}

}  // namespace
}  // namespace posemix
