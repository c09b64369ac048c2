// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "divergence/smooth_ball.hpp"
#include "divergence/trapezoidal_ball.hpp"
#include "divergence/trapezoidal_points.hpp"
#include "small_mixtures.hpp"

/// The trapezoidal rules for divergences on SO(3), and where they apply.
namespace posemix::internal {
namespace {

using Peak = ConcentratedGaussian<SO3d>;
using Peaks = Mixture<Peak>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SO3d turned(RandomStream& stream, double angle) {
  const Eigen::Vector3d v(stream.normal(), stream.normal(), stream.normal());
  return SO3d::exp(angle * v.normalized());
}

/// Components within an angle of a rotation, some far narrower than others.
Peaks random_mixture(std::size_t count, double angle, const SO3d& about, RandomStream& stream) {
  std::vector<Component<Peak>> components;
  for (std::size_t i = 0; i < count; ++i) {
    const double deviation = 0.04 * std::pow(4.0, stream.uniform());
    const SO3d mean = turned(stream, angle * stream.uniform()) * about;
    components.push_back(
        {-stream.uniform(), Peak(mean, testing::correlated(stream, 3, deviation))});
  }
  return Peaks(components);
}

RotationPair pair_of(const Peaks& p, const Peaks& q) {
  return {rotation_peaks(p), rotation_peaks(q)};
}

BallCentre centre_of(const RotationPeak& peak) { return {&peak, 1.0, peak.root}; }

/// The sum of weighted exp(-|x|^2 / 2) f(x) / (2 pi)^1.5 over the points of a rule.
template <class Rule, class F>
double gaussian_mean(const Rule& rule, int level, const F& f) {
  double sum = 0.0;
  rule(level, 9.0, [&](double x, double y, double z, double weight) {
    const Eigen::Vector3d point(x, y, z);
    sum += weight * std::exp(-0.5 * point.squaredNorm() - 1.5 * kLogTwoPi) * f(point);
  });
  return sum;
}

TEST(TrapezoidalPoints, GiveMomentsOfTheGaussian) {
  const auto lattice = [](int level, double radius, const auto& visit) {
    visit_lattice(level, radius, visit);
  };
  const auto half_plane = [](int level, double radius, const auto& visit) {
    visit_half_plane(level, radius, visit);
  };
  const auto expect_moments = [](const auto& rule, int level) {
    const auto mean = [&](auto f) { return gaussian_mean(rule, level, f); };
    EXPECT_NEAR(mean([](const auto&) { return 1.0; }), 1.0, 1e-12);
    EXPECT_NEAR(mean([](const auto& x) { return x.z() * x.z(); }), 1.0, 1e-12);
    EXPECT_NEAR(mean([](const auto& x) { return x.x() * x.x() + x.y() * x.y(); }), 2.0, 1e-12);
    EXPECT_NEAR(mean([](const auto& x) { return std::pow(x.squaredNorm(), 2.0); }), 15.0, 1e-11);
  };
  for (int level = 1; level < 6; ++level) expect_moments(lattice, level);
  for (int level = 2; level < 9; ++level) expect_moments(half_plane, level);
}

TEST(TrapezoidalPoints, LieAtEqualDistances) {
  double nearest = kInfinity;
  double volume = 0.0;
  visit_lattice(0, 9.0, [&](double x, double y, double z, double weight) {
    const double distance = Eigen::Vector3d(x, y, z).norm();
    if (distance > 0.0) nearest = std::min(nearest, distance);
    volume += weight;
  });
  // Body-centred: half the diagonal of a cube of two points.
  const double edge = std::cbrt(2.0) * trapezoidal_spacing(0);
  EXPECT_NEAR(nearest, 0.5 * std::numbers::sqrt3 * edge, 1e-14);
  EXPECT_NEAR(volume / (4.0 / 3.0 * std::numbers::pi * 729.0), 1.0, 0.02);
}

void expect_the_densities_of_the_ray() {
  RandomStream stream(3);
  for (const std::size_t count : {1U, 2U, 5U}) {
    const SO3d about = turned(stream, 2.0);
    const RotationPair pair = pair_of(random_mixture(count, 3.0, about, stream),
                                      random_mixture(1 + count / 2, 3.0, about, stream));
    const BallCentre centre = centre_of(pair.p[0]);
    std::vector<TangentPeak> peaks;
    for (const auto* side : {&pair.p, &pair.q}) {
      for (const RotationPeak& peak : *side) peaks.push_back(tangent_peak(centre, peak));
    }
    TangentView view{{}, peaks.data(), pair.p.size(), peaks.size()};
    Eigen::Map<Eigen::RowVector3d>(view.variances) = centre.root.colwise().squaredNorm();
    TangentBlock block;
    for (std::size_t i = 0; i < kTangentPoints; ++i) {
      const Eigen::Vector3d x = turned(stream, 6.0 * stream.uniform()).log();
      for (std::size_t j = 0; j < 3; ++j)
        block.x[j][i] = i == 0 ? 0.0 : x[static_cast<Eigen::Index>(j)];
    }
    std::vector<double> scratch(2 * kTangentPoints * peaks.size());
    tangent_log_densities(view, block, scratch.data());
    RotationRay ray(pair);
    for (std::size_t i = 0; i < kTangentPoints; ++i) {
      const Eigen::Vector3d x(block.x[0][i], block.x[1][i], block.x[2][i]);
      const Eigen::Vector3d xi = centre.root * x;
      ray.begin(pair.p[0].mean, i == 0 ? Eigen::Vector3d::UnitX() : xi.normalized());
      const auto expected = ray.at(xi.norm());
      EXPECT_NEAR(block.log_p[i], expected.p, 1e-13 * (1.0 + std::abs(expected.p)));
      EXPECT_NEAR(block.log_q[i], expected.q, 1e-13 * (1.0 + std::abs(expected.q)));
      EXPECT_NEAR(block.squared[i], x.squaredNorm(), 1e-14 * x.squaredNorm());
      EXPECT_NEAR(block.mass[i], std::exp(-0.5 * x.squaredNorm()), 1e-14);
    }
  }
}

TEST(TangentKernel, IsTheScalarReferenceOfTheRayByAnyInstructions) {
  by_every_instruction_set(expect_the_densities_of_the_ray);
}

TEST(NarrowestFeature, IsZeroWhereTheCutLocusIsReached) {
  const Eigen::Vector3d variances(0.01, 0.01, 0.09);
  const Integrand ratio{log_ratio, 1.0, false};
  const auto width = [&](const Eigen::Vector3d& offset, double radius) {
    const Peak p(SO3d(), variances.asDiagonal());
    const Peak q(SO3d::exp(offset), variances.asDiagonal());
    const RotationPair pair = pair_of(testing::single(p), testing::single(q));
    return narrowest_feature(pair, ratio, centre_of(pair.p[0]), radius);
  };
  // The cut locus of q is 1.14 rad away: 11 deviations to the side, and 4 along the long axis.
  EXPECT_EQ(width({2.0, 0.0, 0.0}, 6.5), kInfinity);
  EXPECT_EQ(width({0.0, 0.0, 2.0}, 6.5), 0.0);
  EXPECT_EQ(width({0.0, 0.0, 2.0}, 2.5), kInfinity);
  EXPECT_EQ(width({0.0, 0.0, std::numbers::pi}, 2.5), 0.0);
  // A ball that reaches pi itself.
  EXPECT_EQ(width({0.0, 0.0, 0.0}, 11.0), 0.0);
}

TEST(NarrowestFeature, CountsPeaksThatMatter) {
  const auto peak = [](double away, double deviation) {
    const Eigen::Vector3d variances(0.04, deviation * deviation, 0.04);
    return Component<Peak>{-1.0, {SO3d::exp({away, 0.0, 0.0}), variances.asDiagonal()}};
  };
  const auto width = [](DensityFactor factor, const Peaks& q) {
    const RotationPair pair =
        pair_of(testing::single(Peak(SO3d(), 0.04 * Eigen::Matrix3d::Identity())), q);
    return narrowest_feature(pair, {factor, 1.0, false}, centre_of(pair.p[0]), 6.0);
  };
  const Peaks one({peak(0.0, 0.02)});
  EXPECT_NEAR(width(density_gap, one), 0.1, 1e-12);
  EXPECT_EQ(width(log_ratio, one), kInfinity);
  EXPECT_NEAR(width(log_ratio, Peaks({peak(0.0, 0.02), peak(0.1, 0.2)})), 0.1, 1e-12);
}

TEST(TrapezoidalBall, ItsErrorsBoundTheTrueOnes) {
  RandomStream stream(8);
  int resolved = 0;
  for (int i = 0; i < 40; ++i) {
    const SO3d about = turned(stream, 3.0);
    const auto count = static_cast<std::size_t>(i);
    const RotationPair pair = pair_of(random_mixture(1 + count % 4, 0.5, about, stream),
                                      random_mixture(1 + count / 4 % 4, 0.5, about, stream));
    const BallCentre centre = centre_of(pair.p[0]);
    const Integrand integrand{i % 3 == 2 ? density_gap : log_ratio, 1.0, false};
    const double narrowest = narrowest_feature(pair, integrand, centre, 7.5);
    if (!TrapezoidalBall::can_resolve(narrowest, false)) continue;
    ++resolved;
    std::vector<RayIntegral> levels;
    TrapezoidalBall ball(pair, integrand, centre, false, 7.5, narrowest);
    do {
      levels.push_back(ball.total());
    } while (ball.refine(1e-9 * ball.total().absolute));
    for (const RayIntegral& level : levels) {
      const RayIntegral& last = levels.back();
      EXPECT_LE(std::abs(level.value - last.value), level.error + last.error) << i;
    }
  }
  EXPECT_GE(resolved, 20);
}

TEST(TrapezoidalBall, GivesUpWhereItDoesNotConverge) {
  // Two narrow peaks far from each other: a wall between them in log p.
  const auto peak = [](double away) {
    const Eigen::Vector3d variances(4e-4, 4e-4, 4e-4);
    return Component<Peak>{-0.7, {SO3d::exp({away, 0.0, 0.0}), variances.asDiagonal()}};
  };
  const RotationPair pair =
      pair_of(Peaks({peak(0.0), peak(0.13)}),
              testing::single(Peak(SO3d(), 0.04 * Eigen::Matrix3d::Identity())));
  TrapezoidalBall ball(pair, {log_ratio, 1.0, false}, centre_of(pair.p[0]), false, 9.0, 1.0);
  const std::size_t before = ball.total().evaluations;
  EXPECT_FALSE(ball.refine(1e-15));
  EXPECT_EQ(ball.total().evaluations, before);
}

}  // namespace
}  // namespace posemix::internal
