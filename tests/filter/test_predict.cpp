// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "posemix/testing/expect.hpp"
#include "scenario.hpp"

namespace posemix {
namespace {

using testing::correlated_covariance;
using testing::isotropic;
using testing::pose;

PoseStackd camera_motion_object() {
  return PoseStackd(std::vector<SE3d>{pose(0.3, -0.2, 0.5, 0.4, 0.1, -0.6),
                                      pose(0.05, -0.02, 0.04, 0.03, 0.01, -0.02),
                                      pose(1.0, 0.4, -0.3, 0.2, 0.8, 0.5)});
}

TEST(Predict, OdometryMovesTheCameraAndAddsNoiseInItsFrame) {
  RandomStream stream(1);
  const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
  const SE3d motion = pose(0.1, 0.2, -0.1, 0.05, -0.02, 0.1);
  const Matrix6d q = isotropic(0.5, 0.01);
  const Hypothesis after = predict_with_odometry(before, motion, q);
  EXPECT_TRUE(after.mean()[kCamera].is_approx(before.mean()[kCamera] * motion, 1e-14));
  EXPECT_TRUE(after.mean()[2].is_approx(before.mean()[2], 0.0));
  const Eigen::MatrixXd added = after.covariance() - before.covariance();
  const Matrix6d expected =
      after.mean()[kCamera].adjoint() * q * after.mean()[kCamera].adjoint().transpose();
  EXPECT_TRUE(added.topLeftCorner(6, 6).isApprox(expected, 1e-10));
  EXPECT_EQ(added.bottomRows(12).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Predict, RandomWalkLeavesTheMean) {
  RandomStream stream(2);
  const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
  const Hypothesis after = predict_random_walk(before, isotropic(0.5, 0.01));
  EXPECT_TRUE(after.mean().is_approx(before.mean(), 1e-14));
  EXPECT_GT(after.covariance()(0, 0), before.covariance()(0, 0));
}

TEST(Predict, RefusesWhatIsNotFinite) {
  RandomStream stream(2);
  const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const SE3d bad(SO3d(), {0.0, kNan, 0.0});
  const Matrix6d q = isotropic(0.5, 0.01);
  EXPECT_THROW(predict_with_odometry(before, bad, q), InvalidInput);
  EXPECT_THROW(predict_with_odometry(before, SE3d(), kNan * q), InvalidInput);
  EXPECT_THROW(predict_with_odometry(before, SE3d(), -q), InvalidInput);
  EXPECT_THROW(predict_random_walk(before, kNan * q), InvalidInput);
  EXPECT_THROW(predict_constant_velocity(before, kNan, q, q), InvalidInput);
  EXPECT_THROW(predict_constant_velocity(before, 1.0, kNan * q, q), InvalidInput);
  EXPECT_THROW(predict_constant_velocity(before, 1.0, q, -q), InvalidInput);
}

TEST(Predict, RefusesANoiseThatIsNegativeInSomeDirection) {
  RandomStream stream(2);
  const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
  const Matrix6d q = isotropic(0.5, 0.01);
  Matrix6d bad = q;
  bad(0, 5) = bad(5, 0) = 2.0 * std::sqrt(q(0, 0) * q(5, 5));
  EXPECT_THROW(predict_with_odometry(before, SE3d(), bad), InvalidInput);
  EXPECT_THROW(predict_random_walk(before, bad), InvalidInput);
  EXPECT_THROW(predict_constant_velocity(before, 1.0, bad, q), InvalidInput);
  EXPECT_THROW(predict_constant_velocity(before, 1.0, q, bad), InvalidInput);
}

TEST(Predict, ComputesWithTheSymmetricPartOfANoise) {
  RandomStream stream(2);
  const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
  testing::expect_the_symmetric_part_to_count([&](const Matrix6d& q) {
    return Eigen::MatrixXd(
        predict_constant_velocity(predict_random_walk(before, q), 1.0, q, q).covariance());
  });
}

TEST(Predict, RefusesAHypothesisWithoutTheMotion) {
  const Hypothesis camera(PoseStackd({SE3d()}), isotropic(0.5, 0.01));
  const Matrix6d q = isotropic(0.5, 0.01);
  EXPECT_EQ(testing::thrown_message([&] { predict_constant_velocity(camera, 1.0, q, q); }),
            "a hypothesis of 1 poses, expected the motion of the camera at index 1");
}

/// The camera after `periods` of the motion in the state.
PoseStackd moved(const PoseStackd& poses, double periods) {
  PoseStackd result = poses;
  result[kCamera] = poses[kCamera] * SE3d::exp(periods * poses[kMotion].log());
  return result;
}

TEST(Predict, ConstantVelocityMovesTheMeanAndPropagatesTheCovariance) {
  RandomStream stream(3);
  const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
  const Matrix6d none = Matrix6d::Zero();
  for (const double periods : {1.0, 3.0, 0.4}) {
    const Hypothesis after = predict_constant_velocity(before, periods, none, none);
    const PoseStackd expected = moved(before.mean(), periods);
    EXPECT_TRUE(after.mean().is_approx(expected, 1e-13));
    // Jacobian of the error by central differences.
    Eigen::MatrixXd jacobian(18, 18);
    constexpr double kStep = 1e-6;
    for (Eigen::Index i = 0; i < 18; ++i) {
      const auto error = [&](double step) -> Eigen::VectorXd {
        const Eigen::VectorXd xi = step * Eigen::VectorXd::Unit(18, i);
        return (moved(PoseStackd::exp(xi) * before.mean(), periods) * expected.inverse()).log();
      };
      jacobian.col(i) = (error(kStep) - error(-kStep)) / (2.0 * kStep);
    }
    const Eigen::MatrixXd propagated = jacobian * before.covariance() * jacobian.transpose();
    EXPECT_LT((after.covariance() - propagated).cwiseAbs().maxCoeff(), 1e-8)
        << periods << " periods";
  }
}

// To the last bit: what comes later reads one half of it.
TEST(Predict, ConstantVelocityLeavesASymmetricCovariance) {
  RandomStream stream(5);
  for (int i = 0; i < 20; ++i) {
    const Hypothesis before(camera_motion_object(), correlated_covariance(3, stream));
    const Hypothesis after = predict_constant_velocity(before, 0.7 + 0.1 * i, isotropic(0.5, 0.01),
                                                       isotropic(0.2, 0.004));
    EXPECT_EQ(after.covariance(), after.covariance().transpose());
  }
}

TEST(Predict, ConstantVelocityTracksASteadyMotionThatARandomWalkLagsBehind) {
  const SE3d motion = pose(0.02, 0.01, -0.015, 0.01, 0.0, 0.004);
  const DetectorNoise noise = testing::gaussian_noise(1.0, 0.003);
  const SE3d object = pose(0, 0, 0, 0, 0, 2);
  const auto run = [&](bool constant_velocity) {
    Hypothesis start(PoseStackd(std::vector<SE3d>{SE3d()}), isotropic(0.1, 0.001));
    if (constant_velocity) start = with_independent_pose(start, SE3d(), isotropic(5.0, 0.05));
    start = with_independent_pose(start, object, isotropic(0.1, 0.001));
    const std::size_t index = start.mean().size() - 1;
    GaussianSumFilter filter(Posterior({{0.0, start}}), {});
    SE3d truth;
    double error = 0.0;
    for (int frame = 0; frame < 60; ++frame) {
      truth = truth * motion;
      filter.predict([&](Hypothesis h) {
        return constant_velocity
                   ? predict_constant_velocity(std::move(h), 1.0, isotropic(0.05, 1e-4),
                                               isotropic(0.05, 1e-4))
                   : predict_random_walk(std::move(h), isotropic(0.3, 0.003));
      });
      if (frame >= 30) error += (filter.summarise().mean()[kCamera] * truth.inverse()).log().norm();
      const Detection detection{index, truth.inverse() * object, &noise};
      filter.update(std::span(&detection, 1));
    }
    return error / 30.0;
  };
  EXPECT_LT(run(true), 0.2 * run(false));
}

}  // namespace
}  // namespace posemix
