// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "posemix/testing/rotation_quadrature.hpp"

namespace posemix {
namespace {

using Peak = ConcentratedGaussian<SO3d>;
using Peaks = Mixture<Peak>;
using Settings = RotationQuadratureSettings;

Eigen::Matrix3d isotropic(double degrees) {
  return radians(degrees) * radians(degrees) * Eigen::Matrix3d::Identity();
}

/// A correlated covariance with standard deviations of about `deviation`.
Eigen::Matrix3d correlated_covariance(RandomStream& stream, double deviation) {
  Eigen::VectorXd entries(9);
  stream.fill_normal(entries);
  const Eigen::Matrix3d root = entries.reshaped(3, 3);
  Eigen::Matrix3d covariance =
      deviation * deviation * (root * root.transpose() / 3.0 + 0.1 * Eigen::Matrix3d::Identity());
  symmetrize(covariance);
  return covariance;
}

Eigen::Vector3d vector_of_length(RandomStream& stream, double length) {
  Eigen::VectorXd v(3);
  stream.fill_normal(v);
  return length * v.normalized();
}

struct Reference {
  double kl = 0.0;
  double isd = 0.0;
  double symmetric_kl = 0.0;
};

/// The three divergences by a fixed product rule.
Reference by_product_rule(const Peaks& p, const Peaks& q, const SO3d& centre,
                          const testing::BallRule& rule) {
  const Peaks::Evaluator log_p(p);
  const Peaks::Evaluator log_q(q);
  Reference sum;
  rule.for_each(centre, [&](const SO3d& x, double weight) {
    const double at_p = log_p.log_density(x);
    const double at_q = log_q.log_density(x);
    const double density_p = std::exp(at_p);
    const double density_q = std::exp(at_q);
    sum.kl += weight * density_p * (at_p - at_q);
    sum.isd += weight * (density_p - density_q) * (density_p - density_q);
    sum.symmetric_kl += weight * (density_p - density_q) * (at_p - at_q);
  });
  return sum;
}

Peaks peaks_of(const Peak& peak) { return Peaks({{0.0, peak}}); }

void expect_close(const DivergenceEstimate& estimate, double expected, double relative) {
  EXPECT_TRUE(estimate.converged);
  EXPECT_NEAR(estimate.value, expected, relative * std::abs(expected));
  EXPECT_LE(estimate.error, 1.01e-6 * std::abs(estimate.value) + 1e-14);
}

/// The same covariance, no longer symmetric about any axis.
Peak unsymmetric(const Peak& peak) {
  Eigen::Matrix3d covariance = peak.covariance();
  covariance(0, 0) *= 1.0 + 2e-10;
  covariance(1, 1) *= 1.0 - 1e-10;
  return {peak.mean(), covariance};
}

TEST(RotationQuadrature, CorrelatedPeaksAgreeWithAProductRule) {
  RandomStream stream(11);
  for (const double deviation : {0.15, 0.25}) {
    const SO3d mean = SO3d::exp(vector_of_length(stream, 1.0));
    const Peak p(mean, correlated_covariance(stream, deviation));
    const Peak q(SO3d::exp(vector_of_length(stream, 0.3)) * mean,
                 correlated_covariance(stream, 0.3));
    const testing::BallRule rule{.radial_panels = 3, .polar_panels = 2, .azimuths = 100};
    const Reference expected = by_product_rule(peaks_of(p), peaks_of(q), mean, rule);
    expect_close(kl(p, q), expected.kl, 1e-6);
    expect_close(isd(p, q), expected.isd, 1e-6);
    expect_close(symmetric_kl(p, q), expected.symmetric_kl, 1e-6);
  }
}

TEST(RotationQuadrature, MixturesAgreeWithAProductRule) {
  RandomStream stream(12);
  const SO3d mean = SO3d::exp(vector_of_length(stream, 2.0));
  const auto peak = [&](double away, double deviation) {
    return Peak(SO3d::exp(vector_of_length(stream, away)) * mean,
                correlated_covariance(stream, deviation));
  };
  const Peaks p({{std::log(0.6), peak(0.2, 0.2)}, {std::log(0.4), peak(0.4, 0.15)}});
  const Peaks q({{std::log(0.2), peak(0.3, 0.15)}, {std::log(0.8), peak(0.2, 0.2)}});
  const testing::BallRule rule{
      .radius = 2.5, .radial_panels = 2, .polar_panels = 2, .azimuths = 160};
  const Reference expected = by_product_rule(p, q, p[0].density.mean(), rule);
  expect_close(kl(p, q), expected.kl, 5e-6);
  expect_close(isd(p, q), expected.isd, 5e-6);
}

// With one common mean the volume factors cancel in log(p/q): the divergence is that of Gaussians
// on R^3 as long as no mass lies beyond the ball.
TEST(RotationQuadrature, WithACommonMeanItIsTheClosedForm) {
  RandomStream stream(13);
  for (const double deviation : {1e-3, 0.02, 0.2}) {
    for (const double ratio : {1.0, 0.05, 20.0}) {
      const SO3d mean = SO3d::exp(vector_of_length(stream, 1.5));
      const Peak p(mean, correlated_covariance(stream, std::min(0.2, deviation * ratio)));
      const Peak q(mean, correlated_covariance(stream, deviation));
      expect_close(kl(p, q), gaussian_kl(p, q), 1e-7);
      expect_close(symmetric_kl(p, q), gaussian_symmetric_kl(p, q), 1e-6);
    }
  }
}

TEST(RotationQuadrature, ConcentratedPeaksApproachTheClosedFormQuadratically) {
  RandomStream stream(14);
  const Eigen::Matrix3d shape_p = correlated_covariance(stream, 1.0);
  const Eigen::Matrix3d shape_q = correlated_covariance(stream, 1.0);
  const Eigen::Vector3d step = vector_of_length(stream, 1.0);
  const auto error = [&](double scale) {
    const Peak p(SO3d(), scale * scale * shape_p);
    const Peak q(SO3d::exp(scale * step), scale * scale * shape_q);
    return kl(p, q, {.relative_tolerance = 1e-9}).value / gaussian_kl(p, q) - 1.0;
  };
  EXPECT_LT(std::abs(error(1e-3)), 1e-5);
  EXPECT_NEAR(error(0.02) / error(0.01), 4.0, 0.1);
}

Peaks random_mixture(std::size_t count, RandomStream& stream) {
  std::vector<Component<Peak>> components;
  for (std::size_t i = 0; i < count; ++i) {
    const double deviation = std::pow(10.0, -0.5 - 1.3 * stream.uniform());
    components.push_back({std::log(0.1 + stream.uniform()),
                          {SO3d::exp(vector_of_length(stream, std::numbers::pi * stream.uniform())),
                           correlated_covariance(stream, deviation)}});
  }
  return Peaks(components);
}

TEST(RotationQuadrature, ErrorsOfMixturesAreWithinTheirEstimates) {
  RandomStream stream(77);
  for (std::size_t k = 0; k < 12; ++k) {
    const Peaks p = random_mixture(1 + k % 4, stream);
    const Peaks q = random_mixture(1 + k / 4, stream);
    for (auto* divergence : {&kl, &symmetric_kl, &isd}) {
      const DivergenceEstimate found = divergence(p, q, {});
      const DivergenceEstimate finer = divergence(p, q, {.relative_tolerance = 1e-8});
      EXPECT_TRUE(found.converged);
      EXPECT_LE(std::abs(found.value - finer.value), found.error + finer.error) << k;
    }
  }
}

TEST(RotationQuadrature, IsZeroForEqualDensities) {
  RandomStream stream(15);
  const Peak a(SO3d(), correlated_covariance(stream, 0.3));
  const Peak b(SO3d::exp({0.4, 0.2, 0}), correlated_covariance(stream, 0.2));
  const Peaks p({{std::log(0.3), a}, {std::log(0.7), b}});
  const Peaks swapped({{std::log(0.7), b}, {std::log(0.3), a}});
  for (const Peaks& q : {p, swapped}) {
    EXPECT_NEAR(kl(p, q).value, 0.0, 1e-15);
    EXPECT_NEAR(isd(p, q).value, 0.0, 1e-15);
    EXPECT_NEAR(symmetric_kl(p, q).value, 0.0, 1e-15);
    EXPECT_TRUE(kl(p, q).converged);
  }
}

TEST(RotationQuadrature, KeepsRelativeAccuracyForNearlyEqualDensities) {
  RandomStream stream(16);
  const Peak p(SO3d::exp({0.1, 0.2, 0.3}), correlated_covariance(stream, 0.2));
  for (const double change : {1e-3, 1e-5}) {
    const Peak q(p.mean(), (1.0 + change) * p.covariance());
    // (3 / 2) (log(1 + c) - c / (1 + c)), by its series.
    const double expected = 1.5 * (change * change / 2.0 - change * change * change * (2.0 / 3.0));
    expect_close(kl(p, q), expected, 2e-6);
    EXPECT_LE(kl(p, q).error, 1e-5 * expected);
  }
}

TEST(RotationQuadrature, CountsTheMassMissingInTheBall) {
  // So wide that a tenth of the Gaussian mass lies beyond the ball, and nearly equal.
  const Peak p(SO3d(), isotropic(72.0));
  const Peak q(SO3d(), isotropic(75.0));
  const testing::BallRule rule{.radial_panels = 4, .polar_panels = 1, .azimuths = 1};
  const Reference expected = by_product_rule(peaks_of(p), peaks_of(q), SO3d(), rule);
  EXPECT_NEAR(kl(p, q).value, expected.kl, 1e-6 * std::abs(expected.kl));
  EXPECT_NEAR(kl(unsymmetric(p), q).value, expected.kl, 1e-6 * std::abs(expected.kl));
}

TEST(RotationQuadrature, CutLocusNextToTheMean) {
  // The means are 175 deg apart: the log density of q has a kink half a deviation from the mean
  // of p. Reference: the rule about the other end of the axis, cut where the kink is.
  const Peak p(SO3d(), isotropic(10.0));
  const Peak q(SO3d::exp({0, 0, radians(175.0)}), isotropic(20.0));
  const testing::BallRule rule{
      .radius = radians(90.0), .radial_panels = 30, .polar_panels = 30, .azimuths = 1};
  Reference expected = by_product_rule(peaks_of(p), peaks_of(q), SO3d(), rule);
  expect_close(kl(p, q), expected.kl, 5e-6);
  expect_close(kl(unsymmetric(p), q), kl(p, q).value, 2e-6);
}

TEST(RotationQuadrature, VeryDifferentWidths) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -1).normalized();
  const Peak wide(SO3d(), isotropic(25.0));
  const Peak narrow(SO3d::exp(0.5 * axis), isotropic(1.0));
  const Peak other(SO3d::exp(0.2 * axis), isotropic(20.0));
  const Peaks p({{std::log(0.5), wide}, {std::log(0.5), narrow}});
  const testing::BallRule rule{.radial_panels = 30, .polar_panels = 4, .azimuths = 1, .axis = axis};
  const Reference expected = by_product_rule(p, peaks_of(other), narrow.mean(), rule);
  expect_close(kl(p, other), expected.kl, 1e-6);
  expect_close(isd(p, other), expected.isd, 1e-6);
  expect_close(symmetric_kl(p, other), expected.symmetric_kl, 2e-6);
  const Peak general = unsymmetric(other);
  expect_close(kl(p, general), expected.kl, 1e-6);
  expect_close(isd(p, general), expected.isd, 1e-6);
}

TEST(RotationQuadrature, FramesDoNotMatter) {
  RandomStream stream(17);
  const Peak p(SO3d::exp({0.3, 0, 0}), correlated_covariance(stream, 0.5));
  const Peak q(SO3d::exp({0, 0.9, 0.4}), correlated_covariance(stream, 0.4));
  const SO3d left = SO3d::exp({1.0, -2.0, 0.5});
  const auto moved = [&](const Peak& peak) {
    return Peak(left * peak.mean(), left.adjoint_congruence(peak.covariance()));
  };
  const double here = kl(p, q).value;
  EXPECT_NEAR(kl(moved(p), moved(q)).value, here, 2e-6 * here);
  EXPECT_NEAR(kl(inverse(p), inverse(q)).value, here, 2e-6 * here);
  EXPECT_NEAR(symmetric_kl(p, q).value, here + kl(q, p).value, 4e-6 * here);
}

TEST(RotationQuadrature, TheReportedErrorBoundsTheTrueOne) {
  RandomStream stream(18);
  const Settings loose{.relative_tolerance = 1e-2};
  const Settings tight{.relative_tolerance = 1e-4};
  for (int i = 0; i < 4; ++i) {
    const Peak a(SO3d(), correlated_covariance(stream, i % 2 == 0 ? 0.1 : 0.6));
    const Peak b(SO3d::exp(vector_of_length(stream, 0.8 * i)), correlated_covariance(stream, 0.3));
    const Peak c(SO3d::exp(vector_of_length(stream, 0.5)), correlated_covariance(stream, 0.4));
    const Peaks p({{std::log(0.4), a}, {std::log(0.6), b}});
    for (const auto divergence : {kl, isd, symmetric_kl}) {
      const DivergenceEstimate quick = divergence(p, c, loose);
      const DivergenceEstimate exact = divergence(p, c, tight);
      EXPECT_TRUE(quick.converged && exact.converged);
      EXPECT_LE(std::abs(quick.value - exact.value), quick.error + exact.error);
      EXPECT_LE(quick.error, 1.01e-2 * quick.value);
      EXPECT_LE(quick.evaluations, exact.evaluations);
    }
  }
}

TEST(RotationQuadrature, SaysWhenItStoppedEarly) {
  RandomStream stream(19);
  const Peak p(SO3d(), correlated_covariance(stream, 0.7));
  const Peak q(SO3d::exp({0, 2.5, 0}), correlated_covariance(stream, 0.5));
  const DivergenceEstimate exact = kl(p, q);
  const DivergenceEstimate early = kl(p, q, {.relative_tolerance = 1e-9, .max_evaluations = 1000});
  EXPECT_FALSE(early.converged);
  EXPECT_GT(early.error, 1e-9 * early.value);
  EXPECT_LE(std::abs(early.value - exact.value), early.error + exact.error);
  EXPECT_LT(early.evaluations, exact.evaluations);
}

TEST(RotationQuadrature, RejectsAToleranceOfZero) {
  const Peak p(SO3d(), isotropic(5.0));
  EXPECT_THROW(kl(p, p, {.relative_tolerance = 0.0}), InvalidInput);
  EXPECT_THROW(isd(p, p, {.relative_tolerance = -1.0}), InvalidInput);
}

TEST(RotationQuadrature, WeightlessComponentsDoNotCount) {
  const Peak p(SO3d(), isotropic(5.0));
  const Peak q(SO3d::exp({0.1, 0, 0}), isotropic(6.0));
  const double none = -std::numeric_limits<double>::infinity();
  const Peaks with_none({{0.0, p}, {none, Peak(SO3d::exp({0, 1, 0}), isotropic(9.0))}});
  EXPECT_EQ(kl(with_none, q).value, kl(p, q).value);
}

TEST(RunnallsBound, BoundsTheDivergenceThatAMergeOfRotationsCauses) {
  RandomStream stream(20);
  for (int i = 0; i < 4; ++i) {
    const double share = 0.15 + 0.1 * i;
    const Component<Peak> a{std::log(share), Peak(SO3d(), correlated_covariance(stream, 0.05))};
    const Component<Peak> b{std::log(0.6 - share), Peak(SO3d::exp(vector_of_length(stream, 0.1)),
                                                        correlated_covariance(stream, 0.05))};
    const Component<Peak> c{std::log(0.4),
                            Peak(SO3d::exp({0.2, 0, 0}), correlated_covariance(stream, 0.1))};
    const std::array both{a, b};
    const SO3d anchor = interpolate(a.density.mean(), b.density.mean(), (0.6 - share) / 0.6);
    const Peak merged = back_project(tangent_moments<SO3d>(both, anchor));
    const DivergenceEstimate divergence =
        kl(Peaks({a, b, c}), Peaks({{std::log(0.6), merged}, c}), {.relative_tolerance = 1e-4});
    EXPECT_GT(divergence.value, 1e-3);
    EXPECT_GT(runnalls_bound(a, b), divergence.value + divergence.error);
    EXPECT_LT(runnalls_bound(a, b), 20.0 * divergence.value);
  }
}

}  // namespace
}  // namespace posemix
