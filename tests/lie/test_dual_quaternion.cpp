// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "dual_quaternion.hpp"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "posemix/base/error.hpp"
#include "posemix/testing/lie_draw.hpp"

namespace posemix {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

SE3d draw_pose() {
  const Vector3d axis = testing::draw_vector<double, 3>(3, 1.0);
  const double angle = testing::draw_angle<double>();
  const Vector3d phi = axis.norm() > 0.0 ? Vector3d(angle * axis.normalized()) : Vector3d::Zero();
  return SE3d(SO3d::exp(phi), testing::draw_vector<double, 3>(3, 10.0));
}

TEST(DualQuaternion, QuarterTurnWithTranslationByHand) {
  const SE3d pose(SO3d::exp(Vector3d(0, 0, std::numbers::pi / 2)), Vector3d(1, 2, 3));
  const DualQuaterniond x(pose);
  const double h = std::sqrt(0.5);
  EXPECT_LE((x.real().coeffs() - Eigen::Vector4d(0, 0, h, h)).norm(), 1e-15);
  // (0, 1, 2, 3) (h, 0, 0, h) / 2 in order w, x, y, z: (-3h, 3h, h, 3h) / 2.
  EXPECT_LE((x.dual().coeffs() - h / 2 * Eigen::Vector4d(3, 1, 3, -3)).norm(), 1e-15);
  EXPECT_LE((x * Vector3d(1, 0, 0) - Vector3d(1, 3, 3)).norm(), 1e-15);
}

RC_GTEST_PROP(DualQuaternionLaws, IsThereAndBack, ()) {
  const SE3d pose = draw_pose();
  RC_ASSERT(DualQuaterniond(pose).pose().is_approx(pose, 1e-13));
}

RC_GTEST_PROP(DualQuaternionLaws, ComposesAsPosesDo, ()) {
  const SE3d a = draw_pose();
  const SE3d b = draw_pose();
  RC_ASSERT((DualQuaterniond(a) * DualQuaterniond(b)).pose().is_approx(a * b, 1e-13));
}

RC_GTEST_PROP(DualQuaternionLaws, MovesPointsAsPosesDo, ()) {
  const SE3d pose = draw_pose();
  const Vector3d point = testing::draw_vector<double, 3>(3, 10.0);
  RC_ASSERT((DualQuaterniond(pose) * point - pose * point).norm() <= 1e-13);
}

RC_GTEST_PROP(DualQuaternionLaws, QuaternionConjugateIsTheInverse, ()) {
  const SE3d pose = draw_pose();
  const DualQuaterniond x(pose);
  RC_ASSERT(x.quaternion_conjugate().pose().is_approx(pose.inverse(), 1e-13));
  RC_ASSERT((x * x.quaternion_conjugate()).is_approx(DualQuaterniond(), 1e-13));
}

RC_GTEST_PROP(DualQuaternionLaws, CoversPosesTwice, ()) {
  const SE3d pose = draw_pose();
  const DualQuaterniond x(pose);
  const Vector3d point = testing::draw_vector<double, 3>(3, 10.0);
  RC_ASSERT((-x).pose().is_approx(pose, 1e-13));
  RC_ASSERT((-x).is_approx(x, 0.0));
  RC_ASSERT(((-x) * point - x * point).norm() <= 1e-13);
}

RC_GTEST_PROP(DualQuaternionLaws, StaysOnTheUnitDualQuaternions, ()) {
  DualQuaterniond x(draw_pose());
  const DualQuaterniond step(draw_pose());
  for (int i = 0; i < 100; ++i) x = x * step;
  RC_ASSERT(std::abs(x.real().norm() - 1.0) <= 1e-14);
  RC_ASSERT(std::abs(x.real().dot(x.dual())) <= 1e-12 * (1.0 + x.dual().norm()));
}

/// Dual part of a b c, where a point p is 1 + eps p (eq. 3).
Vector3d sandwich(const DualQuaterniond& x, const Vector3d& p, const DualQuaterniond& right) {
  const Quaterniond point(0, p.x(), p.y(), p.z());
  // x (1 + eps p) = q_r + eps (q_d + q_r p)
  const Quaterniond left(Eigen::Vector4d(x.dual().coeffs() + (x.real() * point).coeffs()));
  return (x.real() * right.dual()).vec() + (left * right.real()).vec();
}

// Erratum of the MPG paper: eq. 5 has the quaternion conjugate, with which the translation is lost.
TEST(DualQuaternion, PointsNeedTheTotalConjugate) {
  const SE3d pose(SO3d::exp(Vector3d(0.3, -0.2, 0.5)), Vector3d(1, -2, 3));
  const DualQuaterniond x(pose);
  const Vector3d p(0.4, 0.5, -0.6);
  EXPECT_LE((sandwich(x, p, x.total_conjugate()) - pose * p).norm(), 1e-14);
  EXPECT_LE((sandwich(x, p, x.quaternion_conjugate()) - pose.rotation() * p).norm(), 1e-14);
}

TEST(DualQuaternion, DualConjugateTurnsTheTranslationRound) {
  const SE3d pose(SO3d::exp(Vector3d(0.3, -0.2, 0.5)), Vector3d(1, -2, 3));
  const SE3d turned(pose.rotation(), -pose.translation());
  EXPECT_TRUE(DualQuaterniond(pose).dual_conjugate().pose().is_approx(turned, 1e-15));
}

TEST(DualQuaternion, RefusesPartsThatAreNoMotion) {
  const Quaterniond one = Quaterniond::Identity();
  const Quaterniond imaginary(0, 1, 2, 3);
  EXPECT_NO_THROW(DualQuaterniond::from_parts(one, imaginary));
  EXPECT_THROW(DualQuaterniond::from_parts(Quaterniond(2, 0, 0, 0), imaginary), InvalidInput);
  EXPECT_THROW(DualQuaterniond::from_parts(one, one), InvalidInput);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(DualQuaterniond::from_parts(one, Quaterniond(0, nan, 0, 0)), InvalidInput);
}

}  // namespace
}  // namespace posemix
