// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// The Gaussian of pose, twist and slow error of one object that moves.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "filter/moving/placed_object.hpp"
#include "scenario.hpp"

namespace posemix::internal {
namespace {

using posemix::testing::isotropic;
using posemix::testing::pose;

/// An object in a random state, with or without a twist and a slow error.
PlacedObject placed_object(RandomStream& stream, bool moves, bool has_slow) {
  PlacedObject object{.pose = pose(0.7, -1.2, 0.4, 0.5, -0.3, 1.1)};
  object.covariance = posemix::testing::correlated_covariance(3, stream);
  if (moves) {
    object.twist << 0.9, -0.5, 1.3, 0.4, -0.7, 0.2;
  } else {
    object.covariance.middleRows<6>(kTwistRow).setZero();
    object.covariance.middleCols<6>(kTwistRow).setZero();
  }
  if (has_slow) {
    object.slow << 0.01, -0.02, 0.03, 0.002, 0.001, -0.003;
  } else {
    object.covariance.bottomRows<6>().setZero();
    object.covariance.rightCols<6>().setZero();
  }
  return object;
}

// The scale of the slow error changes, and the pose takes on what it loses.
TEST(PlacedObject, WhatADetectionSeesStaysWhereTheSlowErrorIsRescaled) {
  RandomStream stream(17);
  const ObjectSensor sensor{posemix::testing::gaussian_noise()};
  const KnownFrame camera{.pose = pose(0.1, 0.4, -0.2, 0.0, 0.3, -0.8)};
  const PlacedObject before = placed_object(stream, true, true);
  const Vector6d factor = Vector6d::LinSpaced(0.6, 1.4);
  PlacedObject after = before;
  rescale_slow(after, sensor, camera, factor);
  EXPECT_TRUE(after.slow.isApprox(factor.cwiseProduct(before.slow)));
  const auto block_of = [](const PlacedObject& object, Eigen::Index row, Eigen::Index column) {
    return Matrix6d(object.covariance.block<6, 6>(row, column));
  };
  EXPECT_TRUE(block_of(after, kLastSlowRow, kLastSlowRow)
                  .isApprox(factor.asDiagonal() * block_of(before, kLastSlowRow, kLastSlowRow) *
                            factor.asDiagonal()));
  EXPECT_TRUE(block_of(after, kTwistRow, kTwistRow)
                  .isApprox(block_of(before, kTwistRow, kTwistRow), 1e-14));
  // xi + A b and its covariance with the twist.
  const Matrix6d a =
      slow_error_map(before.seen_from(camera), sensor.noise.components().front(), sensor);
  const Vector6d moved = (after.pose * before.pose.inverse()).log();
  EXPECT_LT((moved + a * (after.slow - before.slow)).norm(), 1e-12);
  Eigen::Matrix<double, 12, 18> seen = Eigen::Matrix<double, 12, 18>::Zero();
  seen.topLeftCorner<6, 6>().setIdentity();
  seen.topRightCorner<6, 6>() = a;
  seen.block<6, 6>(6, kTwistRow).setIdentity();
  EXPECT_TRUE((seen * after.covariance * seen.transpose())
                  .isApprox(seen * before.covariance * seen.transpose(), 1e-12));
  EXPECT_EQ(after.covariance, after.covariance.transpose());
}

/// What pose and twist are by the equivalent pose whose angle about the axes is that of the mean,
/// in the frame of the twist: T Exp(-u), with the body's twist v as Ad_{Exp(u)} v.
Vector12d by_the_angle_of_the_mean(const PlacedObject& object, const SymmetryGroup& symmetries,
                                   MotionFrame frame, const Vector12d& error) {
  const SE3d pose = SE3d::exp(error.head<6>()) * object.pose;
  const Matrix6d unobserved = Matrix6d::Identity() - symmetries.observed_projection();
  const Vector6d u = unobserved * object.pose.inverse().adjoint() * error.head<6>();
  const SE3d equivalent = pose * SE3d::exp(-u);
  const auto turned = [](const SO3d& by, const Vector6d& twist) -> Vector6d {
    return (Vector6d() << by * Eigen::Vector3d(twist.head<3>()),
            by * Eigen::Vector3d(twist.tail<3>()))
        .finished();
  };
  Vector6d twist = object.twist + error.tail<6>();
  if (frame == MotionFrame::world) twist = turned(pose.rotation().inverse(), twist);
  twist = SE3d::exp(u).adjoint() * twist;
  if (frame == MotionFrame::world) twist = turned(equivalent.rotation(), twist);
  Vector12d result;
  result << (equivalent * object.pose.inverse()).log(), twist - object.twist;
  return result;
}

TEST(PlacedObject, AboutAnAxisOfSymmetryTheAngleIsChosenAndTheTwistGoesWithIt) {
  RandomStream stream(18);
  const SymmetryGroup symmetries({}, {SymmetryAxis{.point = {0.1, -0.2, 0.3}}});
  for (const MotionFrame frame : {MotionFrame::object, MotionFrame::world}) {
    const PlacedObject before = placed_object(stream, true, true);
    ConstantVelocityMotion motion{.frame = frame};
    motion.start_sds.setConstant(1e3);
    PlacedObject object = before;
    fix_unobserved(object, symmetries, motion);
    Matrix18d f = Matrix18d::Identity();
    constexpr double kStep = 1e-6;
    for (Eigen::Index k = 0; k < 12; ++k) {
      const Vector12d by = kStep * Vector12d::Unit(k);
      f.col(k).head<12>() = (by_the_angle_of_the_mean(before, symmetries, frame, by) -
                             by_the_angle_of_the_mean(before, symmetries, frame, -by)) /
                            (2.0 * kStep);
    }
    Matrix18d expected = f * before.covariance * f.transpose();
    const Matrix6d fixed = kFixedAngle * symmetries.unobserved_covariance();
    expected.topLeftCorner<6, 6>() += before.pose.adjoint_congruence(fixed);
    EXPECT_TRUE(object.covariance.isApprox(expected, 1e-8));
    EXPECT_TRUE(object.twist.isApprox(before.twist, 1e-12));
  }
}

TEST(PlacedObject, TheSpinAboutAnAxisIsAsCertainAsThatOfAnObjectOfUnknownMotion) {
  RandomStream stream(18);
  const SymmetryGroup symmetries({}, {SymmetryAxis{}});
  PlacedObject object = placed_object(stream, true, true);
  object.covariance *= 1e4;
  const ConstantVelocityMotion motion;
  fix_unobserved(object, symmetries, motion);
  EXPECT_NEAR(object.covariance(kTwistRow + 2, kTwistRow + 2), std::pow(motion.start_sds[2], 2),
              1e-9);
  EXPECT_TRUE(Eigen::LLT<Matrix18d>(object.covariance).info() == Eigen::Success);
}

TEST(PlacedObject, AnObjectWithoutATwistGetsNone) {
  RandomStream stream(19);
  const SymmetryGroup symmetries({}, {SymmetryAxis{}});
  for (const ObjectMotion& motion : std::vector<ObjectMotion>{StaticMotion{}, RandomWalkMotion{}}) {
    PlacedObject object = placed_object(stream, false, true);
    fix_unobserved(object, symmetries, motion);
    EXPECT_TRUE(object.covariance.middleRows<6>(kTwistRow).isZero(0.0));
    EXPECT_TRUE(object.covariance.middleCols<6>(kTwistRow).isZero(0.0));
    EXPECT_TRUE(object.twist.isZero(0.0));
  }
}

TEST(PlacedObject, ASlowErrorDecaysToItsStationaryCovariance) {
  RandomStream stream(20);
  const PlacedObject before = placed_object(stream, true, true);
  const Matrix6d stationary = isotropic(1.5, 0.02);
  PlacedObject after = before;
  decay_slow(after, 1.0, stationary);
  EXPECT_EQ(after.covariance, before.covariance);
  decay_slow(after, 0.0, stationary);
  EXPECT_TRUE(after.slow.isZero(0.0));
  EXPECT_EQ((after.covariance.bottomRightCorner<6, 6>()), stationary);
  EXPECT_TRUE((after.covariance.topRightCorner<12, 6>().isZero(0.0)));
  EXPECT_EQ((after.covariance.topLeftCorner<12, 12>()),
            (before.covariance.topLeftCorner<12, 12>()));
}

}  // namespace
}  // namespace posemix::internal
