// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <limits>

#include <gtest/gtest.h>

#include "numbers.hpp"
#include "posemix/base/error.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using Vector6d = SE3d::Tangent;

using testing::kPi;

Vector6d twist(const Vector3d& phi, const Vector3d& rho) {
  Vector6d xi;
  xi << phi, rho;
  return xi;
}

TEST(SE3, ScrewAboutZ) {
  const auto t = SE3d::exp(twist(Vector3d(0, 0, kPi / 2), Vector3d(1, 0, 3)));
  const double r = 2 / kPi;  // a quarter of a circle of length 1
  EXPECT_LE((t.translation() - Vector3d(r, r, 3)).norm(), 1e-15);
  EXPECT_LE((t * Vector3d(1, 0, 0) - Vector3d(r, r + 1, 3)).norm(), 1e-15);
}

TEST(SE3, MatrixIsHomogeneous) {
  const SE3d t(SO3d::exp(Vector3d(0.1, 0.2, 0.3)), Vector3d(4, 5, 6));
  EXPECT_EQ(t.matrix().row(3), Eigen::RowVector4d(0, 0, 0, 1));
  EXPECT_EQ((t.matrix().topRightCorner<3, 1>()), Vector3d(4, 5, 6));
  EXPECT_TRUE(SE3d::from_matrix(t.matrix()).is_approx(t, 1e-15));
}

TEST(SE3, ComparesRotationAndTranslation) {
  const SE3d t(SO3d::exp(Vector3d(0.1, 0.2, 0.3)), Vector3d(4, 5, 6));
  const SE3d moved(t.rotation(), t.translation() + Vector3d(0, 1e-3, 0));
  const SE3d turned(SO3d::exp(Vector3d(1e-3, 0, 0)) * t.rotation(), t.translation());
  for (const SE3d& other : {moved, turned}) {
    EXPECT_TRUE(t.is_approx(other, 1.1e-3));
    EXPECT_FALSE(t.is_approx(other, 0.9e-3));
  }
}

TEST(SE3, HalfTurnWithTranslation) {
  const SE3d t(SO3d::exp(Vector3d(0, kPi, 0)), Vector3d(1, 2, 3));
  EXPECT_NEAR(t.log().head<3>().norm(), kPi, 1e-15);
  EXPECT_TRUE(SE3d::exp(t.log()).is_approx(t, 1e-14));
}

TEST(SE3, RejectsWhatIsNoPose) {
  Matrix4d bad = Matrix4d::Identity();
  bad(3, 0) = 0.1;
  EXPECT_THROW(SE3d::from_matrix(bad), InvalidInput);
  bad = Matrix4d::Identity();
  bad(0, 3) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(SE3d::from_matrix(bad), InvalidInput);
  bad = Matrix4d::Identity();
  bad(0, 0) = 1.01;
  EXPECT_THROW(SE3d::from_matrix(bad), InvalidInput);
  EXPECT_NO_THROW(SE3d::from_matrix(bad, 0.1));
}

TEST(SE3, CastsBetweenScalars) {
  const SE3d t(SO3d::exp(Vector3d(0.1, 0.2, 0.3)), Vector3d(4, 5, 6));
  EXPECT_TRUE(t.cast<long double>().cast<double>().is_approx(t, 1e-15));
  EXPECT_TRUE(t.cast<float>().cast<double>().is_approx(t, 1e-6));
}

TEST(TwistMatrix, ProductsAreTheDenseOnes) {
  using Dense = SE3d::TangentMatrix;
  const Vector6d xi = twist(Vector3d(0.3, -0.8, 0.2), Vector3d(2, 1, -1));
  const Vector6d eta = twist(Vector3d(-1, 0.1, 0.4), Vector3d(0, 3, 0.5));
  const auto left = SE3d::left_jacobian_blocks(xi);
  const auto right = SE3d::left_jacobian_inverse_blocks(eta);
  const Dense l = left.dense();
  const Dense r = right.dense();
  Dense p;
  for (Eigen::Index i = 0; i < p.size(); ++i) p(i) = static_cast<double>((7 * i) % 11) - 4;
  const auto expect_equal = [](const auto& got, const auto& want) {
    EXPECT_LE((got - want).norm(), 1e-13);
  };
  expect_equal(left.sandwich(p, right), l * p * r.transpose());
  expect_equal((left * right).dense(), l * r);
  expect_equal(left.times(p), l * p);
  expect_equal(left.times(xi), l * xi);
  expect_equal(left.transpose_times(xi), l.transpose() * xi);
  expect_equal(left.transpose_after(p), p * l.transpose());
  const Dense symmetric = p + p.transpose();
  const Dense congruent = left.congruence(symmetric);
  expect_equal(congruent, l * symmetric * l.transpose());
  EXPECT_EQ(congruent, congruent.transpose());
}

}  // namespace
}  // namespace posemix
