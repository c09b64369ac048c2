// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/operations.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/testing/density_draw.hpp"
#include "posemix/testing/expect.hpp"
#include "posemix/testing/rotation_quadrature.hpp"
#include "posemix/testing/statistics.hpp"

namespace posemix {
namespace {

using testing::check_property;
using testing::draw_components;
using Line = ConcentratedGaussian<Rnd<1>>;
using PoseDensity = ConcentratedGaussian<SE3d>;
using Scalar1 = Eigen::Matrix<double, 1, 1>;

Rnd<1> at(double x) { return Rnd<1>(Scalar1(x)); }

Line normal_at(double mean, double variance) { return {at(mean), Scalar1(variance)}; }

double normal(double x, double variance) {
  return std::exp(-0.5 * x * x / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
}

/// Checks a mixture of all pairs: the weight of pair (i, j) at i * b.size() + j is proportional to
/// w_i w_j, its density is that of `operation`.
template <class D, class Operation>
void assert_all_pairs(const Mixture<D>& pairs, const Mixture<D>& a, const Mixture<D>& b,
                      const Operation& operation) {
  RC_ASSERT(pairs.size() == a.size() * b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t k = i * b.size() + j;
      const D expected = operation(a[i].density, b[j].density);
      RC_ASSERT(std::abs(pairs.weight(k) - a.weight(i) * b.weight(j)) < 1e-12);
      RC_ASSERT(pairs[k].density.mean().is_approx(expected.mean(), 1e-12));
      RC_ASSERT(testing::relative_difference(pairs[k].density.covariance(), expected.covariance()) <
                1e-12);
    }
  }
}

TEST(MixtureOperations, ComposeAndBetweenTakeAllPairs) {
  check_property([] {
    const Mixture a(draw_components<SE3d>(2, 0.5, 0.2));
    const Mixture b(draw_components<SE3d>(3, 0.5, 0.2));
    assert_all_pairs(compose(a, b), a, b,
                     [](const auto& x, const auto& y) { return compose(x, y); });
    assert_all_pairs(between(a, b), a, b,
                     [](const auto& x, const auto& y) { return between(x, y); });
  });
}

TEST(MixtureOperations, InverseKeepsWeightsAndDensity) {
  check_property([] {
    const Mixture mixture(draw_components<SE3d>(3, 0.5, 0.5));
    const auto inverted = inverse(mixture);
    const SE3d x = testing::draw_near_identity<SE3d>(0.3) * mixture[0].density.mean();
    const double expected = mixture.log_density(x);
    RC_ASSERT(std::abs(inverted.log_density(x.inverse()) - expected) <
              1e-9 * (1.0 + std::abs(expected)));
  });
}

TEST(MixtureOperations, ComposeAgreesWithMonteCarlo) {
  // On R^1 the composition is the sum; the distribution function is compared at five points.
  const auto a =
      Mixture<Line>::from_weights(std::vector{0.3, 0.7}, {normal_at(-1, 0.2), normal_at(2, 0.5)});
  const auto b =
      Mixture<Line>::from_weights(std::vector{0.6, 0.4}, {normal_at(0, 0.3), normal_at(5, 1.0)});
  const auto sum = compose(a, b);
  constexpr int kDraws = 60'000;
  const std::vector<double> cuts{-1.0, 0.5, 2.0, 4.0, 6.5};
  std::vector<int> below(cuts.size());
  RandomStream stream(41);
  for (int i = 0; i < kDraws; ++i) {
    const double x = (a.sample(stream) * b.sample(stream)).value()[0];
    for (std::size_t k = 0; k < cuts.size(); ++k) below[k] += x < cuts[k] ? 1 : 0;
  }
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    double probability = 0.0;
    for (const auto& node : testing::gauss_legendre(-20.0, cuts[k], 10)) {
      probability += node.weight * std::exp(sum.log_density(at(node.at)));
    }
    const double error = std::sqrt(probability * (1.0 - probability) / kDraws);
    EXPECT_NEAR(static_cast<double>(below[k]) / kDraws, probability, 4.5 * error) << cuts[k];
  }
}

TEST(MixtureOperations, FuseOnTheLineIsTheClosedForm) {
  // w_ij ~ w_i v_j N(a_i - b_j; 0, A_i + B_j), pair N(c, C) with 1/C = 1/A + 1/B.
  const std::vector<double> w{0.3, 0.7};
  const std::vector<double> v{0.6, 0.4};
  const std::vector<double> a{-1.0, 2.0};
  const std::vector<double> b{0.0, 3.0};
  const std::vector<double> var_a{0.2, 0.5};
  const std::vector<double> var_b{0.3, 1.0};
  const auto p =
      Mixture<Line>::from_weights(w, {normal_at(a[0], var_a[0]), normal_at(a[1], var_a[1])});
  const auto q =
      Mixture<Line>::from_weights(v, {normal_at(b[0], var_b[0]), normal_at(b[1], var_b[1])});
  const auto fused = fuse(p, q);
  double evidence = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j)
      evidence += w[i] * v[j] * normal(a[i] - b[j], var_a[i] + var_b[j]);
  }
  EXPECT_TRUE(fused.converged);
  EXPECT_NEAR(fused.log_overlap, std::log(evidence), 1e-12);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t k = 2 * i + j;
      const double weight = w[i] * v[j] * normal(a[i] - b[j], var_a[i] + var_b[j]) / evidence;
      const double variance = 1.0 / (1.0 / var_a[i] + 1.0 / var_b[j]);
      EXPECT_NEAR(fused.density.weight(k), weight, 1e-13) << k;
      EXPECT_NEAR(fused.density[k].density.covariance()(0, 0), variance, 1e-13) << k;
      EXPECT_NEAR(fused.density[k].density.mean().value()[0],
                  variance * (a[i] / var_a[i] + b[j] / var_b[j]), 1e-13)
          << k;
    }
  }
  // The product itself, at a point.
  const double product = p.log_density(at(0.7)) + q.log_density(at(0.7));
  EXPECT_NEAR(fused.density.log_density(at(0.7)) + fused.log_overlap, product, 1e-12);
}

TEST(MixtureOperations, FuseOfDistantMixturesDoesNotUnderflow) {
  // 100 deviations apart: the evidence exp(-2500) is zero in double precision, its log is not.
  const auto p = Mixture<Line>::from_weights(std::vector{1.0}, {normal_at(0.0, 1.0)});
  const auto q = Mixture<Line>::from_weights(std::vector{1.0}, {normal_at(100.0, 1.0)});
  const auto fused = fuse(p, q);
  EXPECT_NEAR(fused.log_overlap, -2500.0 - 0.5 * std::log(4.0 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(fused.density.weight(0), 1.0, 1e-15);
  EXPECT_NEAR(fused.density[0].density.mean().value()[0], 50.0, 1e-12);
}

TEST(MixtureOperations, EvidenceOnRotationsAgreesWithQuadrature) {
  const Eigen::Matrix3d narrow = 0.01 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d wide = Eigen::Vector3d(0.02, 0.04, 0.03).asDiagonal();
  using D = ConcentratedGaussian<SO3d>;
  const SO3d centre = SO3d::exp({0.5, -0.6, 1.0});
  const auto near = [&](double x, double y, double z) { return SO3d::exp({x, y, z}) * centre; };
  const auto p = Mixture<D>::from_weights(
      std::vector{0.4, 0.6}, {D(near(0.1, 0, 0), narrow), D(near(-0.2, 0.3, 0), wide)});
  const auto q = Mixture<D>::from_weights(
      std::vector{0.5, 0.5}, {D(near(0, 0, 0.2), wide), D(near(-0.1, 0.2, 0), narrow)});
  const Mixture<D>::Evaluator log_p(p);
  const Mixture<D>::Evaluator log_q(q);
  const testing::BallRule rule{
      .radius = 1.5, .radial_panels = 2, .polar_panels = 1, .azimuths = 60};
  const double exact = rule.integrate(
      centre, [&](const SO3d& x) { return std::exp(log_p.log_density(x) + log_q.log_density(x)); });
  // Laplace's approximation per pair is off by about the variances, 0.01.
  EXPECT_NEAR(std::exp(fuse(p, q).log_overlap) / exact, 1.0, 0.01);
}

TEST(MixtureOperations, FuseReportsAnyPairThatHasNotConverged) {
  const Matrix6d spread = 0.04 * Matrix6d::Identity();
  const Vector6d step = (Vector6d() << 0.8, -0.5, 0.6, 1.0, -2.0, 0.5).finished();
  const PoseDensity origin(SE3d(), spread);
  const auto p = Mixture<PoseDensity>::from_weights(std::vector{1.0}, {origin});
  const auto q = Mixture<PoseDensity>::from_weights(
      std::vector{0.5, 0.5}, {origin, PoseDensity(SE3d::exp(step), 0.5 * spread)});
  EXPECT_FALSE(fuse(p, q, {.max_iterations = 2}).converged);
  EXPECT_TRUE(fuse(p, q).converged);
}

TEST(MixtureOperations, PartsOfAJointMixtureKeepTheWeights) {
  check_property([] {
    const Mixture joint(draw_components<PoseStackd>(3, 0.3, 0.2));
    const auto pose = marginal(joint, 2);
    const auto relative = relative_pose(joint, 0, 2);
    RC_ASSERT(pose.size() == 3U && relative.size() == 3U);
    for (std::size_t i = 0; i < joint.size(); ++i) {
      const auto expected_pose = marginal(joint[i].density, 2);
      const auto expected_relative = relative_pose(joint[i].density, 0, 2);
      RC_ASSERT(std::abs(pose.weight(i) - joint.weight(i)) < 1e-14);
      RC_ASSERT(std::abs(relative.weight(i) - joint.weight(i)) < 1e-14);
      RC_ASSERT(pose[i].density.covariance() == expected_pose.covariance());
      RC_ASSERT(pose[i].density.mean().is_approx(expected_pose.mean(), 1e-15));
      RC_ASSERT(relative[i].density.covariance() == expected_relative.covariance());
      RC_ASSERT(relative[i].density.mean().is_approx(expected_relative.mean(), 1e-15));
    }
  });
}

}  // namespace
}  // namespace posemix
