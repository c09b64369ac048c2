// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/grasp/success_probability.hpp"
#include "posemix/lie/pose_covariance.hpp"

/// Boxes that reach to turns by pi, where one gnomonic chart ends.
namespace posemix {
namespace {

using Eigen::Vector3d;
using Concentrated = ConcentratedGaussian<SE3d>;

constexpr double kPi = std::numbers::pi;

/// The mug of docs/programs.md, which its detector turns by 180 degrees at times.
Mixture<Concentrated> mug() {
  const SE3d seen(SO3d(), Vector3d(0.0, 0.0, 0.8));
  const SE3d turned(SO3d::from_quaternion({0.0, 0.0, 0.0, 1.0}), seen.translation());
  const Matrix6d in_body =
      pose_covariance(Vector3d::Constant(radians(3.0)), Vector3d(0.004, 0.004, 0.008));
  const double weights[] = {0.7, 0.3};
  return Mixture<Concentrated>::from_weights(
      weights, {Concentrated(seen, seen.adjoint_congruence(in_body)),
                Concentrated(turned, turned.adjoint_congruence(in_body))});
}

bool in_box(const SE3d& pose, const ToleranceBox& box) {
  const Eigen::Vector4d q = pose.rotation().quaternion().coeffs().cwiseAbs();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double turn = box.rotation[i];
    if (turn < kPi && q[i] > std::tan(0.5 * turn) * q[3]) return false;
    if (std::abs(pose.translation()[i]) > box.translation[i]) return false;
  }
  return true;
}

struct Counted {
  double probability;
  double error;
};

template <class D>
Counted counted(const Mixture<D>& mixture, const ToleranceBox& box, const SE3d& m, int draws) {
  RandomStream stream(17);
  const SE3d to_box = m.inverse();
  int inside = 0;
  for (int i = 0; i < draws; ++i) inside += in_box(to_box * mixture.sample(stream), box) ? 1 : 0;
  const double p = static_cast<double>(inside) / draws;
  return {p, std::sqrt((p * (1.0 - p) + 1.0 / draws) / draws)};
}

/// Far from the truth by no more than a correct estimate with few replicates is.
template <class D>
void expect_agreement(const Mixture<D>& mixture, const ToleranceBox& box, const SE3d& m,
                      int draws) {
  RandomStream stream(5);
  const SuccessEstimate found = success_probability(mixture, box, m, stream);
  const Counted expected = counted(mixture, box, m, draws);
  EXPECT_NEAR(found.probability, expected.probability,
              5.0 * std::hypot(found.error, expected.error));
  EXPECT_GE(found.probability, 0.0);
  EXPECT_LE(found.probability, 1.0);
}

ToleranceBox turns(const Vector3d& degrees, double metres = 1.0) {
  return {kRadPerDeg * degrees, Vector3d::Constant(metres)};
}

TEST(HalfTurns, OfAComponentByPiFromTheGraspAreSeen) {
  const Mixture<Concentrated> mixture = mug();
  const SE3d m = mixture[0].density.mean();
  // By counting 400,000 draws, with standard errors of up to 0.0007.
  const struct {
    Vector3d degrees;
    double counted;
  } cases[] = {{Vector3d::Constant(150.0), 0.7000}, {Vector3d::Constant(170.0), 0.7000},
               {Vector3d::Constant(175.0), 0.729},  {Vector3d::Constant(178.0), 0.851},
               {Vector3d::Constant(179.0), 0.922},  {Vector3d::Constant(179.9), 0.992},
               {{60.0, 60.0, 179.9}, 0.748}};
  for (const auto& [degrees, expected] : cases) {
    SCOPED_TRACE(degrees.transpose());
    RandomStream stream(1);
    const auto found = success_probability(mixture, turns(degrees), m, stream);
    EXPECT_NEAR(found.probability, expected, 0.003);
    EXPECT_LT(found.error, 1e-3);
    expect_agreement(mixture, turns(degrees), m, 100000);
  }
}

TEST(HalfTurns, AnyTurnAboutAnAxisIsAllowedByPi) {
  const Mixture<Concentrated> mixture = mug();
  const SE3d m = mixture[0].density.mean();
  for (const Vector3d& degrees :
       {Vector3d(60.0, 60.0, 180.0), Vector3d(20.0, 180.0, 180.0), Vector3d(8.0, 5.0, 180.0)}) {
    SCOPED_TRACE(degrees.transpose());
    expect_agreement(mixture, turns(degrees, 0.01), m, 100000);
    const SE3d turned = m * SE3d(SO3d::exp({0.0, 0.0, 1.3}), Vector3d::Zero());
    expect_agreement(mixture, turns(degrees, 0.01), turned, 100000);
  }
  RandomStream stream(1);
  const auto all = success_probability(mixture, turns(Vector3d::Constant(180.0)), m, stream);
  EXPECT_NEAR(all.probability, 1.0, 1e-3);
  EXPECT_LE(all.probability, 1.0);
}

TEST(HalfTurns, TheErrorIsThatOfRepeatedEstimates) {
  const Mixture<Concentrated> mixture = mug();
  const SE3d m = mixture[0].density.mean();
  const ToleranceBox box = turns(Vector3d::Constant(177.0));
  RandomStream reference(7);
  const double exact =
      success_probability(mixture, box, m, reference, {.points = 1 << 14}).probability;
  double squares = 0.0;
  const int runs = 40;
  for (int i = 0; i < runs; ++i) {
    RandomStream stream(8, static_cast<std::uint64_t>(i));
    const auto found = success_probability(mixture, box, m, stream, {.points = 64});
    squares += std::pow((found.probability - exact) / found.error, 2) / runs;
  }
  EXPECT_GT(squares, 0.3);
  EXPECT_LT(squares, 3.0);
}

/// Widths from 2 to 60 degrees at angles from 0 to pi, also about an axis of the box.
TEST(HalfTurns, WideComponentsAgreeWithCounting) {
  RandomStream random(23);
  const auto vector = [&] { return Vector3d(random.normal(), random.normal(), random.normal()); };
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE(i);
    Matrix6d root;
    for (double& value : root.reshaped()) value = random.normal();
    const double width = 0.03 * std::pow(30.0, random.uniform());
    Vector6d scale;
    scale << Vector3d::Constant(width), Vector3d::Constant(0.008);
    const Matrix6d covariance = scale.asDiagonal() *
                                (root * root.transpose() / 6.0 + 0.2 * Matrix6d::Identity()) *
                                scale.asDiagonal();
    const SE3d mean(SO3d::exp({0.3, -0.4, 0.8}), Vector3d(0.1, 0.2, 0.6));
    const Vector3d axis = i % 3 == 0 ? vector().normalized() : Vector3d(Vector3d::Unit(i % 2 + 1));
    const double angle = i % 4 == 0 ? kPi : kPi * random.uniform();
    const SE3d m = mean * SE3d(SO3d::exp(angle * axis), Vector3d(0.003, 0.0, 0.002));
    ToleranceBox box = turns({180.0, 180.0, 180.0}, 0.02);
    for (double& turn : box.rotation) {
      if (random.uniform() < 0.6) turn = radians(40.0 + 139.0 * random.uniform());
    }
    const double weights[] = {1.0};
    const Matrix6d left = mean.adjoint_congruence(covariance);
    expect_agreement(Mixture<Concentrated>::from_weights(weights, {Concentrated(mean, left)}), box,
                     m, 50000);
    Matrix6d half = covariance;
    half.topRows<3>() *= 0.5;
    half.leftCols<3>() *= 0.5;
    using Projected = ProjectedGaussian<SE3d>;
    expect_agreement(Mixture<Projected>::from_weights(weights, {Projected(mean, half)}), box, m,
                     50000);
  }
}

TEST(HalfTurns, FewPointsStayProbabilities) {
  const Mixture<Concentrated> mixture = mug();
  const SE3d m = mixture[0].density.mean();
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream stream(3, seed);
    const auto found = success_probability(mixture, turns({179.0, 179.5, 170.0}), m, stream,
                                           {.points = 4, .replicates = 2});
    EXPECT_GE(found.probability, 0.0);
    EXPECT_LE(found.probability, 1.0);
    EXPECT_TRUE(std::isfinite(found.error));
  }
}

TEST(HalfTurns, TheBestGraspCoversBothPeaks) {
  RandomStream stream(2);
  const auto best = best_grasp(mug(), turns({20.0, 20.0, 180.0}, 0.02), stream);
  RandomStream at_mode(2);
  const auto mode = success_probability(mug(), turns({20.0, 20.0, 180.0}, 0.02),
                                        mug()[0].density.mean(), at_mode);
  EXPECT_GT(best.success.probability, mode.probability + 0.2);
}

}  // namespace
}  // namespace posemix
