// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "filter/multi_object/significant_motion.hpp"
#include "moving_object_scene.hpp"

/// What of a motion is beyond its noise.
namespace posemix {
namespace {

using internal::near_body;
using internal::SignificantMotion;
using internal::SignificantPose;
using internal::WorldShift;
using testing::draw;
using testing::isotropic;
using testing::pose;

const Matrix6d kNoise = isotropic(0.1, 1e-3);

Vector6d draw_plane(const Matrix6d& covariance, RandomStream& stream) {
  Vector6d error;
  for (double& one : error) one = stream.normal();
  return covariance.diagonal().cwiseSqrt().cwiseProduct(error);
}

/// A step as its odometry says it is.
SE3d measured(const SE3d& step, const Matrix6d& q, RandomStream& stream) {
  return step * SE3d::exp(draw(q, stream));
}

TEST(SignificantMotion, IsAllOfAMotionFarBeyondItsNoise) {
  SignificantMotion motion;
  const SE3d step = pose(0.2, -0.1, 0.3, 0.1, 0.2, -0.3);
  for (int k = 0; k < 20; ++k)
    EXPECT_LT((motion.take(step, kNoise).inverse() * step).log().norm(), 1e-12);
}

TEST(SignificantMotion, IsAllOfAnExactOne) {
  SignificantMotion motion;
  const SE3d step = pose(1e-6, 0.0, 0.0, 0.0, 1e-5, 0.0);
  EXPECT_LT((motion.take(step, Matrix6d::Zero()).inverse() * step).log().norm(), 1e-12);
  EXPECT_TRUE(motion.take(SE3d(), Matrix6d::Zero()).log().isZero(0.0));
}

TEST(SignificantMotion, IsNoneOfABodyThatStands) {
  RandomStream stream(1, 5);
  SignificantMotion motion;
  int taken = 0;
  for (int k = 0; k < 20'000; ++k) {
    taken += motion.take(measured(SE3d(), kNoise, stream), kNoise).log().isZero(0.0) ? 0 : 1;
    if (k % 3 == 0) motion.see();
  }
  EXPECT_LE(taken, 1);
}

TEST(SignificantMotion, StepsAddUpBetweenDetections) {
  RandomStream stream(1, 5);
  SignificantMotion motion;
  const SE3d step = pose(0.0, 0.0, 0.0, 2e-3, 0.0, 0.0);  // two standard deviations
  double taken = 0.0;
  for (int k = 0; k < 1000; ++k) {
    taken += motion.take(measured(step, kNoise, stream), kNoise).translation()[0];
    if (k % 25 == 24) motion.see();
  }
  EXPECT_GT(taken, 1.4);
  EXPECT_LT(taken, 2.1);
  for (int k = 0; k < 1000; ++k) {
    EXPECT_TRUE(motion.take(step, kNoise).log().isZero(0.0));
    motion.see();
  }
}

/// As where a robot on a plane, whose odometry errs in the plane alone, has axes that are tilted.
TEST(SignificantMotion, OfACovarianceWithoutAnInverseIsNoMoreThanTheMotion) {
  RandomStream stream(1, 5);
  const SE3d tilt = pose(0.5, 0.3, 0.2, 0.0, 0.0, 0.0);
  Matrix6d plane = Matrix6d::Zero();
  plane.diagonal() << 0.0, 0.0, 3e-6, 1e-6, 1e-6, 0.0;
  Matrix6d q = tilt.adjoint_congruence(plane);
  for (double& one : q.reshaped()) one = std::round(one * 1e18) * 1e-18;  // twelve digits
  symmetrize(q);
  SignificantMotion motion;
  const SE3d step = tilt * pose(0.0, 0.0, 0.01, 0.01, 0.0, 0.0) * tilt.inverse();
  for (int k = 0; k < 1000; ++k) {
    const SE3d given = step * tilt * SE3d::exp(draw_plane(plane, stream)) * tilt.inverse();
    const Vector6d taken = motion.take(given, q).log();
    EXPECT_LT((taken - given.log()).norm(), 5.0 * step.log().norm());
  }
}

TEST(SignificantMotion, ALargeErrorDoesNotHideWhatComesAfterADetection) {
  SignificantMotion motion;
  const SE3d step = pose(0.0, 0.0, 0.05, 0.02, 0.0, 0.0);
  EXPECT_TRUE(motion.take(step, isotropic(5.0, 0.5)).log().isZero(0.0));
  motion.see();
  EXPECT_LT((motion.take(step, kNoise).inverse() * step).log().norm(), 1e-12);
}

/// Of a robot on a plane, in a body whose axes are tilted against it: how far it moves across.
double across(const SE3d& tilt, std::uint64_t seed) {
  RandomStream stream(seed, 5);
  SignificantMotion motion;
  const SE3d step = tilt * pose(0.0, 0.0, 0.05, 0.03, 0.0, 0.0) * tilt.inverse();
  double sum = 0.0;
  for (int k = 0; k < 10'000; ++k) {
    const SE3d taken = motion.take(measured(step, kNoise, stream), kNoise);
    motion.see();
    EXPECT_GT(taken.log().norm(), 0.9 * step.log().norm());
    if (k >= 100) sum += std::pow((tilt.inverse() * taken * tilt).log()[5], 2);
  }
  return std::sqrt(sum / 9'900.0);
}

TEST(SignificantMotion, OfARobotOnAPlaneIsInThePlaneWhateverItsAxesAre) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    EXPECT_LT(across(SE3d(), seed), 2e-4);  // a fifth of the noise
    EXPECT_LT(across(pose(0.5, 0.3, 0.0, 0.0, 0.0, 0.0), seed), 2e-4);
  }
}

TEST(SignificantPose, IsTheMeanOfWhatIsGivenOfABodyThatStands) {
  RandomStream stream(1, 5);
  SignificantPose body;
  const SE3d truth = pose(0.3, -0.2, 0.5, 1.0, 2.0, 0.3);
  SE3d last;
  for (int k = 0; k < 2000; ++k) {
    const SE3d now = body.follow(measured(truth, kNoise, stream), kNoise);
    if (k >= 1000) {
      EXPECT_LT((last.inverse() * now).translation().norm(), 5e-6);
    }
    last = now;
  }
  EXPECT_LT((truth.inverse() * last).translation().norm(), 2e-4);
}

TEST(SignificantPose, ForgetsAPoorPoseThatWasGivenFirst) {
  RandomStream stream(1, 5);
  SignificantPose body;
  const SE3d truth = pose(0.3, -0.2, 0.5, 1.0, 2.0, 0.3);
  body.follow(truth * pose(0.2, -0.1, 0.1, 0.3, 0.3, -0.3), isotropic(10.0, 0.4));
  for (int k = 0; k < 5; ++k) {
    const SE3d now = body.follow(measured(truth, kNoise, stream), kNoise);
    EXPECT_LT((truth.inverse() * now).translation().norm(), 5e-3);
  }
}

TEST(SignificantPose, FollowsABodyThatMoves) {
  RandomStream stream(1, 5);
  SignificantPose body;
  SE3d truth = pose(0.3, -0.2, 0.5, 1.0, 2.0, 0.3);
  const SE3d step = pose(0.1, 0.2, -0.3, 0.1, 0.05, -0.1);
  for (int k = 0; k < 100; ++k) {
    truth = truth * step;
    const SE3d now = body.follow(measured(truth, kNoise, stream), kNoise);
    EXPECT_LT((truth.inverse() * now).log().cwiseQuotient(kNoise.diagonal().cwiseSqrt()).norm(),
              8.0);
  }
}

/// No nearer than eight standard deviations, and by steps that are small where the body's are.
TEST(NearBody, FollowsBeyondWhatDetectionsAloneTellOfABodyThatStands) {
  const SE3d at = pose(0.3, -0.2, 0.5, 1.0, 2.0, 0.3);
  const Matrix6d noise = isotropic(1.0, 2e-3);
  const auto deviations = [&](const SE3d& from, const SE3d& to) {
    return (to * from.inverse()).log().cwiseQuotient(noise.diagonal().cwiseSqrt()).norm();
  };
  const SE3d near = SE3d::exp(Vector6d::Unit(4) * 0.0159) * at;
  EXPECT_TRUE((near_body(at, near, noise).inverse() * at).log().isZero(0.0));
  SE3d follower = at;
  SE3d body = at;
  for (int k = 0; k < 100; ++k) {
    body = SE3d::exp(Vector6d::Unit(4) * 5e-3) * body;
    const SE3d before = follower;
    follower = near_body(follower, body, noise);
    EXPECT_LT(deviations(before, follower), 2.5 + 1e-9);
    EXPECT_LT(deviations(follower, body), 8.0 + 1e-9);
  }
  EXPECT_NEAR(deviations(follower, body), 8.0, 1e-9);
}

/// Ten kilometres away, with axes along which it never moved, too.
TEST(SignificantPose, IsTheSameFarFromTheOrigin) {
  RandomStream stream(1, 5);
  const SE3d shift(SO3d(), Eigen::Vector3d(1e4, -2e3, 30.0));
  SignificantPose near;
  SignificantPose far;
  SE3d truth = pose(0.3, -0.2, 0.5, 1.0, 2.0, 0.3);
  for (int k = 0; k < 60; ++k) {
    if (k % 20 > 15) truth = truth * pose(0, 0, 0.03, 0.02, 0, 0);
    const SE3d given = measured(truth, kNoise, stream);
    const SE3d one = near.follow(given, kNoise);
    const SE3d other = shift.inverse() * far.follow(shift * given, kNoise);
    const Vector6d apart = (one.inverse() * other).log();
    EXPECT_LT(apart.cwiseQuotient(kNoise.diagonal().cwiseSqrt()).norm(), 1e-4) << k;
  }
}

TEST(SignificantPose, MovesWithTheWorld) {
  SignificantPose near;
  SignificantPose far;
  const WorldShift shift({100.0, -50.0, 3.0});
  const SE3d first = pose(0.3, -0.2, 0.5, 1.0, 2.0, 0.3);
  const SE3d second = first * pose(0.1, 0.2, -0.3, 0.1, 0.05, -0.1);
  near.follow(first, kNoise);
  far.follow(first, kNoise);
  far.move_world(shift);
  const SE3d expected = shift(near.follow(second, kNoise));
  EXPECT_LT((expected.inverse() * far.follow(shift(second), kNoise)).log().norm(), 1e-12);
}

}  // namespace
}  // namespace posemix
