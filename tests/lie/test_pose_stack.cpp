// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "posemix/base/error.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

PoseStackd example(std::size_t size) {
  VectorXd xi(6 * static_cast<Eigen::Index>(size));
  for (Eigen::Index i = 0; i < xi.size(); ++i) xi(i) = 0.3 * static_cast<double>((5 * i) % 7) - 0.8;
  return PoseStackd::exp(xi);
}

TEST(PoseStack, IsAListOfPoses) {
  PoseStackd stack(2);
  EXPECT_EQ(stack.size(), 2u);
  EXPECT_EQ(stack.dof(), 12);
  stack.push_back(SE3d(SO3d(), {1, 2, 3}));
  stack[0] = stack[2];
  EXPECT_EQ(stack[0].translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(stack.dof(), 18);
  double sum = 0;
  for (const SE3d& pose : std::as_const(stack)) sum += pose.translation().x();
  EXPECT_EQ(sum, 2);
  EXPECT_EQ(stack.poses().size(), 3u);
  EXPECT_EQ(PoseStackd().dof(), 0);
}

TEST(PoseStack, ActsPoseByPose) {
  const PoseStackd a = example(3);
  const PoseStackd b = a.inverse();
  const PoseStackd product = a * a;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(product[i].is_approx(a[i] * a[i], 0.0));
    EXPECT_TRUE(b[i].is_approx(a[i].inverse(), 0.0));
    // By vector instructions, with other roundings.
    EXPECT_TRUE(a.log().segment<6>(6 * static_cast<Eigen::Index>(i)).isApprox(a[i].log(), 1e-15));
  }
}

TEST(PoseStack, MatricesAreBlockDiagonal) {
  const PoseStackd a = example(2);
  const VectorXd xi = a.log();
  const MatrixXd j = PoseStackd::left_jacobian(xi);
  EXPECT_EQ((j.block<6, 6>(6, 6)), SE3d::left_jacobian(xi.tail<6>()));
  EXPECT_TRUE(j.topRightCorner(6, 6).isZero(0.0));
  EXPECT_EQ((a.adjoint().block<6, 6>(0, 0)), a[0].adjoint());
  EXPECT_EQ((PoseStackd::ad(xi).block<6, 6>(0, 0)), SE3d::ad(xi.head<6>()));
}

TEST(PoseStack, CongruenceReadsTheUpperBlocksOnly) {
  const PoseStackd a = example(3);
  MatrixXd p = MatrixXd::Identity(18, 18) + 0.1 * MatrixXd::Ones(18, 18);
  const MatrixXd want = a.adjoint_congruence(p);
  p.block<6, 6>(6, 0).setConstant(99);
  p.block<6, 12>(12, 0).setConstant(99);
  EXPECT_EQ(a.adjoint_congruence(p), want);
}

TEST(PoseStack, ASumOfCongruencesIsTheSumOfThem) {
  const VectorXd xi = 0.5 * example(3).log();
  const MatrixXd root = MatrixXd::NullaryExpr(18, 18, [](Eigen::Index i, Eigen::Index j) {
    return std::sin(static_cast<double>(1 + 3 * i + 7 * j));
  });
  const MatrixXd p = root * root.transpose();
  MatrixXd sum = MatrixXd::Identity(18, 18);
  PoseStackd::add_left_jacobian_inverse_congruence(xi, p, 0.3, sum);
  const MatrixXd j = PoseStackd::left_jacobian_inverse(xi);
  const MatrixXd expected = MatrixXd::Identity(18, 18) + 0.3 * j * p * j.transpose();
  EXPECT_LT((sum - expected).norm(), 1e-13 * expected.norm());
  MatrixXd small = MatrixXd::Zero(12, 12);
  EXPECT_THROW(PoseStackd::add_left_jacobian_inverse_congruence(xi, p, 0.3, small), InvalidInput);
  EXPECT_THROW(PoseStackd::add_left_jacobian_inverse_congruence(xi, small, 0.3, sum), InvalidInput);
}

TEST(PoseStack, AssignmentOfTheSameSizeKeepsItsStorage) {
  PoseStackd a(4);
  const PoseStackd b = example(4);
  const SE3d* storage = a.poses().data();
  a = b;
  EXPECT_EQ(a.poses().data(), storage);
  EXPECT_TRUE(a.is_approx(b, 0.0));
}

TEST(PoseStack, RejectsSizesThatDoNotFit) {
  EXPECT_THROW(PoseStackd::exp(VectorXd::Zero(7)), InvalidInput);
  EXPECT_THROW(PoseStackd::left_jacobian(VectorXd::Zero(5)), InvalidInput);
  EXPECT_THROW(PoseStackd::log_abs_det_left_jacobian(VectorXd::Zero(1)), InvalidInput);
  EXPECT_THROW(PoseStackd(2) * PoseStackd(3), InvalidInput);
  EXPECT_THROW(PoseStackd(2).adjoint_congruence(MatrixXd::Identity(6, 6)), InvalidInput);
  EXPECT_THROW(PoseStackd::left_jacobian_congruence(VectorXd::Zero(12), MatrixXd::Identity(12, 18)),
               InvalidInput);
  // That of double has vector instructions, and is a function of its own.
  EXPECT_THROW(PoseStack<float>(2).adjoint_congruence(Eigen::MatrixXf::Identity(6, 6)),
               InvalidInput);
  EXPECT_FALSE(PoseStackd(2).is_approx(PoseStackd(3), 1.0));
  EXPECT_FALSE(PoseStackd(3).is_approx(example(3), 1e-3));
}

TEST(Rn, IsTheVectorSpace) {
  const Rnd<3> a(Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ((a * a).value(), Eigen::Vector3d(2, 4, 6));
  EXPECT_EQ(Rnd<3>().value(), Eigen::Vector3d::Zero());
  EXPECT_TRUE(a.is_approx(Rnd<3>(Eigen::Vector3d(1, 2, 3.1)), 0.11));
  EXPECT_FALSE(a.is_approx(Rnd<3>(Eigen::Vector3d(1, 2, 3.1)), 0.09));
}

TEST(Rn, SizesAtRunTime) {
  using Vector = Rnd<Eigen::Dynamic>;
  EXPECT_EQ(Vector().dof(), 0);
  EXPECT_EQ(Vector(VectorXd::Ones(4)).identity().value(), VectorXd::Zero(4));
  EXPECT_THROW(Vector(VectorXd::Ones(4)) * Vector(VectorXd::Ones(5)), InvalidInput);
  EXPECT_FALSE(Vector(VectorXd::Ones(4)).is_approx(Vector(VectorXd::Ones(5)), 10));
}

}  // namespace
}  // namespace posemix
