// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>

#include <gtest/gtest.h>

#include "posemix/base/units.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/testing/statistics.hpp"
#include "projected_oracle.hpp"

// Oracles: numpy prototypes of the formulas.
namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Gaussian = ProjectedGaussian<SE3d>;

Gaussian outer() {
  return oracle::gaussian({0.4, -0.7, 0.2}, {0.5, 0.1, -0.2}, oracle::second_covariance());
}
Gaussian inner() {
  return oracle::gaussian({-0.3, 0.5, 1.1}, {0.3, -0.2, 0.4}, oracle::first_covariance());
}

/// Mean log density of a density at samples.
template <class Draw>
double mean_log_density(const Gaussian& density, int samples, const Draw& draw) {
  const Gaussian::Evaluator evaluator(density);
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) sum += evaluator.log_density(draw());
  return sum / samples;
}

TEST(ProjectedCompose, JacobianAgreesWithTheOracle) {
  const Gaussian composed = compose(outer(), inner(), CompositionRule::jacobian);
  EXPECT_LT(oracle::quaternion_distance(
                composed.mean().rotation(),
                {0.8002284297171541, -0.1686158166948324, -0.1757331070691744, 0.5480155487872275}),
            1e-13);
  EXPECT_LT((composed.mean().translation() -
             Vector3d(0.5531581696209067, -0.2360806104981573, 0.217401524014636))
                .norm(),
            1e-14);
  Vector6d diagonal;
  diagonal << 0.025675234096604, 0.027917829925878, 0.025418935977517, 0.011833355162080,
      0.012162457773549, 0.006998002226348;
  EXPECT_LT((composed.covariance().diagonal() - diagonal).norm(), 1e-13);
  EXPECT_NEAR(composed.covariance()(0, 3), 8.519388292167e-3, 1e-14);
  EXPECT_NEAR(composed.covariance().determinant() / 2.906204600226e-12, 1.0, 1e-10);
}

TEST(ProjectedCompose, MeanOfTheTranslation) {
  // The mean under the distributions is known exactly: E[R2] E[t1] + E[t2].
  const Vector3d exact(0.552280759620911, -0.224246578943763, 0.200493537004670);
  const Vector3d by_moments = moments_of(outer()).rotation * moments_of(inner()).mean.tail<3>() +
                              moments_of(outer()).mean.tail<3>();
  EXPECT_LT((by_moments - exact).norm(), 1e-12);
  const auto mean = [](CompositionRule rule) {
    return Vector3d(compose(outer(), inner(), rule).tangent_mean().tail<3>());
  };
  EXPECT_LT((mean(CompositionRule::cubature) - exact).norm(), 2e-4);
  EXPECT_LT((mean(CompositionRule::third_degree_cubature) -
             Vector3d(0.552272284, -0.224660365, 0.200943393))
                .norm(),
            1e-9);
}

Gaussian with_rotation_spread(const Gaussian& density, double degrees_per_axis) {
  Matrix6d covariance = density.covariance();
  Vector6d scale;
  const Vector6d spread = covariance.diagonal().cwiseSqrt();
  for (int i = 0; i < 6; ++i) {
    scale[i] = (i < 3 ? std::tan(0.5 * radians(degrees_per_axis)) : 0.02) / spread[i];
  }
  covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  return {density.mean(), covariance};
}

/// The expected log density of the projected Gaussian of maximum likelihood minus that of the
/// composition, by samples [nats].
struct Gaps {
  double cubature;
  double third_degree;
  double jacobian;
};

Gaps gaps(double degrees_per_axis) {
  const Gaussian x = with_rotation_spread(outer(), degrees_per_axis);
  const Gaussian y = with_rotation_spread(inner(), degrees_per_axis);
  RandomStream stream(3);
  std::vector<SE3d> samples;
  for (int i = 0; i < 60000; ++i) samples.push_back(x.sample(stream) * y.sample(stream));
  SO3d centre = (x.mean() * y.mean()).rotation();
  Vector6d mean;
  Matrix6d moment;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Gaussian chart(SE3d(centre, Vector3d::Zero()), Matrix6d::Identity());
    mean.setZero();
    moment.setZero();
    for (const SE3d& sample : samples) {
      const Vector6d y3 = chart.coordinates(sample);
      mean += y3;
      moment += y3 * y3.transpose();
    }
    mean /= static_cast<double>(samples.size());
    moment = moment / static_cast<double>(samples.size()) - mean * mean.transpose();
    if (mean.head<3>().norm() < 1e-9) break;
    centre = gnomonic::project(centre, 0.7 * mean.head<3>());
  }
  const Gaussian best = with_moments<SE3d>(centre, mean, moment);
  const auto score = [&](const Gaussian& density) {
    std::size_t next = 0;
    return mean_log_density(density, static_cast<int>(samples.size()),
                            [&] { return samples[next++]; });
  };
  const auto gap = [&](CompositionRule rule) { return score(best) - score(compose(x, y, rule)); };
  return {gap(CompositionRule::cubature), gap(CompositionRule::third_degree_cubature),
          gap(CompositionRule::jacobian)};
}

TEST(ProjectedCompose, CubatureIsNearTheMaximumLikelihood) {
  const double largest[][2] = {{5.0, 0.001}, {10.0, 0.002}, {15.0, 0.01}, {20.0, 0.03}};
  for (const auto& [degrees_per_axis, limit] : largest) {
    const Gaps found = gaps(degrees_per_axis);
    EXPECT_LT(found.cubature, limit) << degrees_per_axis;
    EXPECT_LT(found.cubature, found.third_degree) << degrees_per_axis;
    EXPECT_LT(found.third_degree, found.jacobian) << degrees_per_axis;
  }
}

TEST(ProjectedCompose, RotationsComposeLikePoses) {
  const auto x = rotation_marginal(outer());
  const auto y = rotation_marginal(inner());
  for (const CompositionRule rule : {CompositionRule::cubature, CompositionRule::jacobian}) {
    const ProjectedGaussian<SO3d> rotation = compose(x, y, rule);
    const ProjectedGaussian<SO3d> of_poses = rotation_marginal(compose(outer(), inner(), rule));
    EXPECT_TRUE(rotation.mean().is_approx(of_poses.mean(), 0.01));
    EXPECT_LT((rotation.covariance() - of_poses.covariance()).norm(), 2e-3);
  }
}

TEST(ProjectedInverse, UndoesItself) {
  const auto rotation = rotation_marginal(inner());
  const auto twice = inverse(inverse(rotation));
  EXPECT_LT((twice.covariance() - rotation.covariance()).norm(), 1e-14);
  const Gaussian narrow(inner().mean(), 1e-4 * inner().covariance());
  for (const CompositionRule rule : {CompositionRule::cubature, CompositionRule::jacobian}) {
    const Gaussian back = inverse(inverse(narrow, rule), rule);
    EXPECT_LT((back.covariance() - narrow.covariance()).norm(), 1e-3 * narrow.covariance().norm());
    EXPECT_TRUE(back.mean().is_approx(narrow.mean(), 1e-4));
  }
}

TEST(ProjectedInverse, HasTheMomentsOfInvertedSamples) {
  const Gaussian inverted = inverse(inner());
  const DistributionMoments<SE3d> distribution = moments_of(inverted);
  RandomStream stream(4);
  testing::SampleMoments moments(6);
  for (int i = 0; i < 40000; ++i) {
    moments.add(inverted.coordinates(inner().sample(stream).inverse()));
  }
  EXPECT_LT(moments.worst_score(distribution.mean, distribution.covariance, 0.01), 4.5);
}

TEST(ProjectedBetween, IsTheInverseComposed) {
  const Gaussian direct = between(outer(), inner());
  const Gaussian in_two = compose(inverse(outer()), inner());
  EXPECT_TRUE(direct.mean().is_approx(in_two.mean(), 0.01));
  EXPECT_LT((direct.covariance() - in_two.covariance()).norm(), 2e-3);
  const Gaussian linear = between(outer(), inner(), CompositionRule::jacobian);
  EXPECT_TRUE(linear.mean().is_approx(outer().mean().inverse() * inner().mean(), 1e-12));
}

TEST(ProjectedTransform, MovesTheDensity) {
  const SE3d a = SE3d::exp((Vector6d() << 0.3, -1.2, 0.4, 0.1, 0.2, -0.5).finished());
  const SE3d at = inner().element(inner().tangent_mean() + 0.1 * Vector6d::Ones());
  EXPECT_NEAR(transform(a, inner()).log_density(a * at), inner().log_density(at), 1e-11);
  const SE3d turn(a.rotation(), Vector3d::Zero());
  EXPECT_NEAR(transform(inner(), turn).log_density(at * turn), inner().log_density(at), 1e-11);

  const Gaussian narrow(inner().mean(), 1e-4 * inner().covariance());
  const Gaussian moved = transform(narrow, a);
  const Gaussian linear = transform(narrow, a, CompositionRule::jacobian);
  EXPECT_TRUE(linear.mean().is_approx(narrow.mean() * a, 1e-12));
  EXPECT_LT((moved.covariance() - linear.covariance()).norm(), 1e-3 * linear.covariance().norm());
}

}  // namespace
}  // namespace posemix
