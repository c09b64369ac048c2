// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/gaussian_isd.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/divergence/so3_quadrature.hpp"
#include "posemix/testing/statistics.hpp"
#include "small_mixtures.hpp"

namespace posemix {
namespace {

using testing::correlated;
using testing::single;
using Vectors = Rnd<Eigen::Dynamic>;

template <LieGroup G>
ConcentratedGaussian<G> peak(RandomStream& stream, Eigen::Index n, double away, double deviation) {
  Eigen::VectorXd xi(n);
  stream.fill_normal(xi);
  return {G::exp(away * xi), correlated(stream, n, deviation)};
}

template <LieGroup G>
Mixture<ConcentratedGaussian<G>> pair_of_peaks(RandomStream& stream, Eigen::Index n) {
  return Mixture<ConcentratedGaussian<G>>({{std::log(0.3), peak<G>(stream, n, 0.1, 0.3)},
                                           {std::log(0.7), peak<G>(stream, n, 0.1, 0.25)}});
}

/// Over many seeds the squared errors in units of the standard error must have the mean of the
/// squared Student t with replicates - 1 degrees: (r - 1) / (r - 3), within its own statistical
/// error.
void expect_coverage(const std::function<DivergenceEstimate(RandomStream&)>& estimate,
                     double exact) {
  constexpr int kSeeds = 100;
  double squares = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    RandomStream stream(101, static_cast<std::uint64_t>(seed));
    const DivergenceEstimate e = estimate(stream);
    EXPECT_GT(e.error, 0.0);
    squares += std::pow((e.value - exact) / e.error, 2);
  }
  const auto [low, high] = testing::chi_square_band(kSeeds, 1e-4);
  EXPECT_GT(squares, low);
  EXPECT_LT(squares, high * 31.0 / 29.0);
}

const DivergenceSamplingSettings kSmall{.samples = 4096, .replicates = 32};

TEST(MonteCarlo, KlOnVectorsIsTheClosedFormWithinItsError) {
  RandomStream draw(1);
  const auto p = peak<Vectors>(draw, 4, 0.2, 0.5);
  const auto q = peak<Vectors>(draw, 4, 0.2, 0.6);
  expect_coverage([&](RandomStream& s) { return kl_monte_carlo(single(p), single(q), s, kSmall); },
                  gaussian_kl(p, q));
  expect_coverage(
      [&](RandomStream& s) { return symmetric_kl_monte_carlo(single(p), single(q), s, kSmall); },
      gaussian_symmetric_kl(p, q));
}

TEST(MonteCarlo, IsdOnVectorsIsTheClosedFormWithinItsError) {
  RandomStream draw(2);
  const auto p = pair_of_peaks<Vectors>(draw, 3);
  const auto q = pair_of_peaks<Vectors>(draw, 3);
  expect_coverage([&](RandomStream& s) { return isd_monte_carlo(p, q, s, kSmall); },
                  gaussian_isd(p, q));
}

TEST(MonteCarlo, OnRotationsItAgreesWithTheQuadrature) {
  RandomStream draw(3);
  for (const double deviation : {0.3, 1.2}) {
    const auto p = single(peak<SO3d>(draw, 3, 0.3, deviation));
    const auto q = single(peak<SO3d>(draw, 3, 0.3, deviation));
    const RotationQuadratureSettings tight{.relative_tolerance = 1e-5};
    expect_coverage([&](RandomStream& s) { return kl_monte_carlo(p, q, s, kSmall); },
                    kl(p, q, tight).value);
    expect_coverage([&](RandomStream& s) { return isd_monte_carlo(p, q, s, kSmall); },
                    isd(p, q, tight).value);
  }
}

TEST(MonteCarlo, OnPosesWithOneMeanItIsTheClosedForm) {
  // The volume factors cancel in log(p/q), and no rotation reaches pi.
  RandomStream draw(4);
  const auto p = peak<SE3d>(draw, 6, 0.5, 0.2);
  const ConcentratedGaussian<SE3d> q(p.mean(), correlated(draw, 6, 0.25));
  expect_coverage([&](RandomStream& s) { return kl_monte_carlo(single(p), single(q), s, kSmall); },
                  gaussian_kl(p, q));
}

TEST(MonteCarlo, OnStacksOfPosesWithOneMeanItIsTheClosedForm) {
  RandomStream draw(5);
  const auto p = peak<PoseStackd>(draw, 12, 0.5, 0.1);
  const ConcentratedGaussian<PoseStackd> q(p.mean(), correlated(draw, 12, 0.12));
  RandomStream stream(6);
  const DivergenceEstimate e = kl_monte_carlo(single(p), single(q), stream);
  EXPECT_NEAR(e.value, gaussian_kl(p, q), 5.0 * e.error);
  EXPECT_LT(e.error, 1e-3 * e.value);
}

TEST(MonteCarlo, SymmetricKlOnPosesIsTheSumOfBoth) {
  RandomStream draw(7);
  const auto p = pair_of_peaks<SE3d>(draw, 6);
  const auto q = pair_of_peaks<SE3d>(draw, 6);
  RandomStream stream(8);
  const DivergenceEstimate forward = kl_monte_carlo(p, q, stream);
  const DivergenceEstimate backward = kl_monte_carlo(q, p, stream);
  const DivergenceEstimate both = symmetric_kl_monte_carlo(p, q, stream);
  const double error = std::hypot(forward.error, backward.error, both.error);
  EXPECT_NEAR(both.value, forward.value + backward.value, 5.0 * error);
  EXPECT_LT(error, 0.02 * both.value);
}

TEST(MonteCarlo, IsFarMoreAccurateThanIndependentSamples) {
  RandomStream draw(9);
  const auto p = peak<SE3d>(draw, 6, 0.5, 0.2);
  const ConcentratedGaussian<SE3d> q(p.mean(), correlated(draw, 6, 0.25));
  RandomStream stream(10);
  const DivergenceEstimate e = kl_monte_carlo(single(p), single(q), stream);
  RandomStream independent(11);
  const ConcentratedGaussian<SE3d>::Evaluator log_p(p);
  const ConcentratedGaussian<SE3d>::Evaluator log_q(q);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kCount = 4096;
  for (int i = 0; i < kCount; ++i) {
    const SE3d x = p.sample(independent);
    const double h = log_p.log_density(x) - log_q.log_density(x);
    sum += h;
    squares += h * h;
  }
  const double variance = squares / kCount - std::pow(sum / kCount, 2);
  EXPECT_LT(e.error, 0.3 * std::sqrt(variance / static_cast<double>(e.evaluations)));
}

TEST(MonteCarlo, TheStreamDeterminesTheResult) {
  RandomStream draw(12);
  const auto p = pair_of_peaks<SE3d>(draw, 6);
  const auto q = pair_of_peaks<SE3d>(draw, 6);
  const auto estimate = [&](std::uint64_t seed) {
    RandomStream stream(seed);
    return kl_monte_carlo(p, q, stream, kSmall).value;
  };
  EXPECT_EQ(estimate(1), estimate(1));
  EXPECT_NE(estimate(1), estimate(2));
}

TEST(MonteCarlo, RejectsBadInput) {
  RandomStream stream(13);
  const auto p = single(peak<Vectors>(stream, 2, 0.1, 0.3));
  const auto q = single(peak<Vectors>(stream, 3, 0.1, 0.3));
  EXPECT_THROW(kl_monte_carlo(p, q, stream), InvalidInput);
  EXPECT_THROW(isd_monte_carlo(p, p, stream, {.samples = 100, .replicates = 1}), InvalidInput);
  EXPECT_THROW(isd_monte_carlo(p, p, stream, {.samples = 10, .replicates = 16}), InvalidInput);
  EXPECT_THROW(gaussian_isd(p, q), InvalidInput);
}

TEST(GaussianIsd, ByHandOnTheLine) {
  // N(0, 1) and N(2, 1): 2 (1 - exp(-1)) / sqrt(4 pi).
  using Line = ConcentratedGaussian<Rnd<1>>;
  using One = Eigen::Matrix<double, 1, 1>;
  const Mixture<Line> p({{0.0, Line(Rnd<1>(One(0.0)), One(1.0))}});
  const Mixture<Line> q({{0.0, Line(Rnd<1>(One(2.0)), One(1.0))}});
  EXPECT_NEAR(gaussian_isd(p, q), 2.0 * (1.0 - std::exp(-1.0)) / std::sqrt(4.0 * M_PI), 1e-15);
  EXPECT_EQ(gaussian_isd(p, p), 0.0);
}

}  // namespace
}  // namespace posemix
