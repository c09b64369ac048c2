// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

#include <gtest/gtest.h>

#include "numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/lie/lie.hpp"
#include "posemix/testing/expect.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::thrown_message;

using testing::kInf;
using testing::kNan;
using testing::kPi;

TEST(SO3, QuarterTurnAboutZ) {
  const auto r = SO3d::exp(Vector3d(0, 0, kPi / 2));
  EXPECT_LE((r * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 4e-16);
  EXPECT_NEAR(r.angle(), kPi / 2, 4e-16);
  EXPECT_TRUE(r.is_approx(SO3d::exp(Vector3d(0, 0, kPi / 2 + 1e-9)), 1.1e-9));
  EXPECT_FALSE(r.is_approx(SO3d::exp(Vector3d(0, 0, kPi / 2 + 1e-9)), 0.9e-9));
}

TEST(SO3, HalfTurnsHaveAValidLog) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, -1),
                               Vector3d(-0.6, 0.8, 0), Vector3d(0, -0.6, 0.8)}) {
    const Quaterniond q(0.0, axis.x(), axis.y(), axis.z());
    const Quaterniond minus(-0.0, -axis.x(), -axis.y(), -axis.z());
    const Vector3d phi = SO3d::from_quaternion(q).log();
    EXPECT_NEAR(phi.norm(), kPi, 5e-16);
    EXPECT_LE(phi.cross(axis).norm(), 1e-15);
    EXPECT_EQ(phi, SO3d::from_quaternion(minus).log());
    EXPECT_TRUE(SO3d::exp(phi).is_approx(SO3d::from_quaternion(q), 1e-15));
  }
}

TEST(SO3, HalfTurnMatricesAreRead) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0.36, -0.48, 0.8)}) {
    const Matrix3d r = 2 * axis * axis.transpose() - Matrix3d::Identity();
    const Vector3d phi = SO3d::from_matrix(r).log();
    EXPECT_NEAR(phi.norm(), kPi, 1e-15);
    EXPECT_LE(phi.cross(axis).norm(), 2e-15);
  }
}

TEST(SO3, StoredQuaternionsAreKeptBitByBit) {
  const auto turn = SO3d::exp(Vector3d(0.3, -0.2, 1.1));
  SO3d rotation;
  for (int i = 0; i < 1000; ++i) {
    rotation = rotation * turn;
    const auto again = SO3d::from_stored_quaternion(rotation.quaternion());
    EXPECT_EQ(again.quaternion().coeffs(), rotation.quaternion().coeffs());
  }
  const Quaterniond rough(0.6000001, 0.8, 0.0, 0.0);
  EXPECT_EQ(SO3d::from_stored_quaternion(rough).quaternion().coeffs(),
            SO3d::from_quaternion(rough).quaternion().coeffs());
  EXPECT_THROW(SO3d::from_stored_quaternion(Quaterniond(kNan, 0, 0, 1)), InvalidInput);
}

TEST(SO3, SignOfTheQuaternionDoesNotMatter) {
  const Quaterniond q(0.2, -0.5, 0.7, 0.4);
  const Quaterniond minus(-0.2, 0.5, -0.7, -0.4);
  const auto a = SO3d::from_quaternion(q);
  const auto b = SO3d::from_quaternion(minus);
  EXPECT_EQ(a.log(), b.log());
  EXPECT_EQ(a.matrix(), b.matrix());
  EXPECT_EQ(a.angle(), b.angle());
  EXPECT_TRUE(a.is_approx(b, 1e-15));
}

TEST(SO3, QuaternionsAreNormalised) {
  for (const double scale : {1e-300, 1e-8, 1.0, 3.0, 1e200}) {
    const Quaterniond q(0.2 * scale, -0.5 * scale, 0.7 * scale, 0.4 * scale);
    EXPECT_NEAR(SO3d::from_quaternion(q).quaternion().norm(), 1.0, 3e-16);
  }
}

TEST(SO3, StaysARotationOverAMillionProducts) {
  const auto step = SO3d::exp(Vector3d(0.1, -0.3, 0.7));
  SO3d r;
  for (int i = 0; i < 1'000'000; ++i) r = r * step;
  EXPECT_NEAR(r.quaternion().norm(), 1.0, 1e-15);
}

TEST(SO3, ProjectsToTheNearestRotation) {
  const auto r = SO3d::exp(Vector3d(0.4, 1.0, -0.2));
  const Matrix3d stretched = r.matrix() * Vector3d(1 + 3e-7, 1 - 2e-7, 1).asDiagonal();
  EXPECT_TRUE(SO3d::from_matrix(stretched).is_approx(r, 1e-12));
  // Also from afar, where the steps of Newton and Schulz alone led half a turn away.
  for (const double factor : {0.01, 1.8, 2.0, 3.0, 1e6})
    EXPECT_TRUE(SO3d::from_matrix(factor * r.matrix(), 1e13).is_approx(r, 1e-12)) << factor;
  EXPECT_EQ(thrown_message([] { SO3d::from_matrix(Matrix3d::Zero(), 2.0); }),
            "rotation matrix has determinant 0; expected +1");
  EXPECT_THROW(SO3d::from_matrix(stretched, 1e-8), InvalidInput);
}

TEST(SO3, RejectsWhatIsNoRotation) {
  EXPECT_EQ(thrown_message([] { SO3d::from_quaternion(Quaterniond(0, 0, 0, 0)); }),
            "quaternion has zero norm; expected a non-zero one");
  for (const double bad : {kNan, kInf}) {
    EXPECT_EQ(thrown_message([&] { SO3d::from_quaternion(Quaterniond(1, 0, bad, 0)); }),
              "quaternion has a component that is not finite");
  }
  EXPECT_EQ(
      thrown_message([] { SO3d::from_matrix(1.1 * Matrix3d::Identity()); }),
      "rotation matrix is not orthonormal: an entry of R^T R - I is 0.21; expected at most 1e-06");
  EXPECT_EQ(thrown_message([] { SO3d::from_matrix(Vector3d(1, 1, -1).asDiagonal()); }),
            "rotation matrix has determinant -1 (a reflection); expected +1");
  EXPECT_EQ(thrown_message([] { SO3d::from_matrix(Matrix3d::Constant(kNan)); }),
            "rotation matrix has an entry that is not finite");
}

TEST(SO3, CastsBetweenScalars) {
  const auto r = SO3d::exp(Vector3d(0.4, 1.0, -0.2));
  EXPECT_TRUE(r.cast<long double>().cast<double>().is_approx(r, 1e-15));
  EXPECT_TRUE(r.cast<float>().cast<double>().is_approx(r, 1e-6));
}

}  // namespace
}  // namespace posemix
