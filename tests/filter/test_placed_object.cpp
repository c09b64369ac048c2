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

// An axis of symmetry along z: the angle and the rate about it are free, and known to nobody.
TEST(PlacedObject, PoseAndTwistAboutAnAxisOfSymmetryAreIndependentAndNotCertain) {
  RandomStream stream(18);
  const SymmetryGroup symmetries({}, {SymmetryAxis{}});
  const double fixed = kFixedAngle * symmetries.unobserved_covariance()(2, 2);
  for (const MotionFrame frame : {MotionFrame::object, MotionFrame::world}) {
    PlacedObject object = placed_object(stream, true, true);
    fix_unobserved(object, symmetries, ConstantVelocityMotion{.frame = frame});
    // Pose and twist along the object's axes.
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = object.pose.rotation().inverse().matrix();
    turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
    Matrix18d to_object = Matrix18d::Identity();
    to_object.topLeftCorner<6, 6>() = object.pose.inverse().adjoint();
    if (frame == MotionFrame::world) to_object.block<6, 6>(kTwistRow, kTwistRow) = turn;
    const Matrix18d local = to_object * object.covariance * to_object.transpose();
    for (const Eigen::Index angle : {Eigen::Index{2}, kTwistRow + 2}) {
      Eigen::VectorXd with_others = local.col(angle);
      EXPECT_NEAR(with_others[angle] / fixed, 1.0, 1e-6);
      with_others[angle] = 0.0;
      EXPECT_LT(with_others.norm(), 1e-6 * fixed);
    }
    const Vector6d twist = to_object.block<6, 6>(kTwistRow, kTwistRow) * object.twist;
    EXPECT_NEAR(twist[2], 0.0, 1e-12);
    EXPECT_GT(twist.head<2>().norm(), 0.1);
  }
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
