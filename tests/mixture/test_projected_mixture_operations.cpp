// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/mixture/projected_operations.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Rotation = ProjectedGaussian<SO3d>;
using Pose = ProjectedGaussian<SE3d>;

/// Rotations about x by `at` degrees: half of the weight on a narrow component, half on a wide one.
/// A standard deviation of rotation is twice that of u.
Mixture<Rotation> narrow_and_wide(double at) {
  const SO3d centre = SO3d::exp({radians(at), 0.0, 0.0});
  const auto isotropic = [&](double degrees_of_rotation) {
    const double u = 0.5 * radians(degrees_of_rotation);
    return Rotation(centre, Matrix3d(u * u * Matrix3d::Identity()));
  };
  const double weights[] = {0.5, 0.5};
  return Mixture<Rotation>::from_weights(weights, {isotropic(6.0), isotropic(24.0)});
}

// Oracle: numpy prototype, weights by integration over the rotations; log evidence with respect to
// the half sphere of quaternions.
TEST(ProjectedMixtureFuse, WeightsOfCaseA) {
  const auto p = narrow_and_wide(0.0), q = narrow_and_wide(8.0);
  const double exact[] = {0.84848, 0.06213, 0.06213, 0.02725};
  const auto fused = fuse(p, q);
  ASSERT_EQ(fused.density.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(fused.density.weight(i), exact[i], 1e-4);
  EXPECT_NEAR(fused.log_overlap + gnomonic::kLogHaarPerHalfSphere, 3.406191996, 1e-3);

  const auto jacobian = fuse(p, q, {.pair = {.rule = FusionRule::jacobian}});
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(jacobian.density.weight(i), exact[i], 1e-3);

  const double paper[] = {0.18267, 0.27021, 0.27021, 0.27691};
  const auto alpha_delta =
      fuse(p, q, {.pair = {.rule = FusionRule::jacobian}, .weight = PairWeight::alpha_delta});
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(alpha_delta.density.weight(i), paper[i], 5e-5);
}

TEST(ProjectedMixtureFuse, JacobianDropsPairsBeyondItsAngle) {
  const auto p = narrow_and_wide(0.0);
  const auto far = narrow_and_wide(40.0);
  EXPECT_THROW(fuse(p, far, {.pair = {.rule = FusionRule::jacobian}}), InvalidInput);
  EXPECT_THROW(fuse(p, far, {.weight = PairWeight::alpha_delta}), InvalidInput);
  EXPECT_EQ(fuse(p, far).density.size(), 4u);
}

TEST(ProjectedMixtureFuse, IsTheProductPointByPoint) {
  const auto p = narrow_and_wide(0.0), q = narrow_and_wide(8.0);
  const auto fused = fuse(p, q);
  for (const double at : {-10.0, 0.0, 4.0, 12.0}) {
    const SO3d rotation = SO3d::exp({radians(at), 0.05, -0.08});
    EXPECT_NEAR(fused.density.log_density(rotation) + fused.log_overlap,
                p.log_density(rotation) + q.log_density(rotation), 0.01);
  }
}

TEST(ProjectedMixtureFuse, KeepsBothWaysRound) {
  const double weights[] = {1.0};
  const Matrix3d wide = 0.1 * Matrix3d::Identity();
  const auto at = [&](double degrees_of_rotation) {
    return Mixture<Rotation>::from_weights(
        weights, {Rotation(SO3d::exp({radians(degrees_of_rotation), 0.0, 0.0}), wide)});
  };
  const auto fused = fuse(at(0.0), at(178.0));
  ASSERT_EQ(fused.density.size(), 2u);
  EXPECT_GT(fused.density.weight(0), fused.density.weight(1));
  EXPECT_GT(fused.density.weight(1), 0.2);
}

Pose lever(double degrees_per_axis, const Vector3d& translation) {
  const double u = 0.5 * radians(degrees_per_axis);
  Vector6d variance;
  variance << u * u, u * u, u * u, 4e-4, 4e-4, 4e-4;
  return {SE3d(SO3d::exp({0.2, 0.4, -0.3}), translation), Matrix6d(variance.asDiagonal())};
}

TEST(ProjectedMixtureCompose, SplittingWideElementsGainsLikelihood) {
  const double weights[] = {1.0};
  const auto x = Mixture<Pose>::from_weights(weights, {lever(20.0, {0.1, 0.0, 0.0})});
  const auto y = Mixture<Pose>::from_weights(weights, {lever(20.0, {0.0, 0.0, 0.54})});
  const auto one = compose(x, y);
  const auto split = compose(x, y, {.split_above = radians(15.0)});
  EXPECT_EQ(one.size(), 1u);
  EXPECT_EQ(split.size(), 27u);
  const auto per_element = Mixture<Pose>::Evaluator(one);
  const auto per_pieces = Mixture<Pose>::Evaluator(split);
  RandomStream stream(11);
  double gain = 0.0;
  const int samples = 20000;
  for (int i = 0; i < samples; ++i) {
    const SE3d pose = x.sample(stream) * y.sample(stream);
    gain += (per_pieces.log_density(pose) - per_element.log_density(pose)) / samples;
  }
  EXPECT_GT(gain, 0.3);
}

TEST(ProjectedMixtureCompose, GoesWithTheElements) {
  const auto x = narrow_and_wide(10.0), y = narrow_and_wide(30.0);
  const auto both = compose(x, y);
  ASSERT_EQ(both.size(), 4u);
  EXPECT_TRUE(both[1].density.mean().is_approx(compose(x[0].density, y[1].density).mean(), 1e-14));
  const SO3d fixed = SO3d::exp({0.0, 1.0, 0.0});
  const SO3d at = SO3d::exp({0.3, 0.1, 0.0});
  EXPECT_NEAR(transform(fixed, x).log_density(fixed * at), x.log_density(at), 1e-12);
  EXPECT_NEAR(transform(x, fixed).log_density(at * fixed), x.log_density(at), 1e-12);
  EXPECT_NEAR(inverse(x).log_density(at.inverse()), x.log_density(at), 1e-12);
  EXPECT_TRUE(
      between(x, y)[0].density.mean().is_approx(SO3d::exp({radians(20.0), 0.0, 0.0}), 1e-9));
  EXPECT_THROW(compose(x, y, {.split_above = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace posemix
