// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/batch.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "posemix/base/random.hpp"

// Oracle: the templates of SO3 and SE3 in long double.
namespace posemix {
namespace {

using internal::by_every_instruction_set;
using SO3l = SO3<long double>;
using SE3l = SE3<long double>;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Of the size of a value: what batch.hpp promises.
constexpr double kTolerance = 1e-13;

/// Angles of zero, tiny ones, near pi and beyond it, with translations from a micrometre to a
/// thousand kilometres. Their number is no multiple of a vector's length.
std::vector<Vector6d> tangents() {
  RandomStream stream(5);
  std::vector<Vector6d> result;
  for (const double angle :
       {0.0, 1e-160, 1e-9, 1e-7, 1e-3, 0.1, 0.5, 1.0, 1.9999, 2.0001, 3.0, std::numbers::pi - 1e-9,
        std::numbers::pi, 3.9999, 4.0, 4.0001, 5.0, 6.0, 9.0}) {
    for (const double distance : {1e-6, 1.0, 1e6}) {
      Vector6d xi;
      for (double& x : xi) x = stream.normal();
      xi.head<3>() *= angle / xi.head<3>().norm();
      xi.tail<3>() *= distance;
      result.push_back(xi);
    }
  }
  return result;
}

std::vector<Eigen::Vector3d> all_rotation_vectors() {
  std::vector<Eigen::Vector3d> result;
  for (const Vector6d& xi : tangents()) result.emplace_back(xi.head<3>());
  return result;
}

std::vector<SE3d> poses() {
  std::vector<SE3d> result;
  for (const Vector6d& xi : tangents()) result.push_back(SE3d::exp(xi));
  return result;
}

std::vector<SO3d> rotations() {
  std::vector<SO3d> result;
  for (const SE3d& pose : poses()) result.push_back(pose.rotation());
  return result;
}

template <class Item>
std::vector<Item> reversed(const std::vector<Item>& x) {
  return {x.rbegin(), x.rend()};
}

std::vector<Matrix6d> covariances(std::uint64_t seed) {
  RandomStream stream(seed);
  std::vector<Matrix6d> result(tangents().size());
  for (Matrix6d& p : result) {
    Matrix6d root;
    for (double& x : root.reshaped()) x = stream.normal();
    p = root * root.transpose();
  }
  return result;
}

SO3l exact(const SO3d& x) { return x.cast<long double>(); }
SE3l exact(const SE3d& x) { return x.cast<long double>(); }

void expect_near(const SO3d& found, const SO3l& expected, const char* name) {
  EXPECT_LT(static_cast<double>((exact(found).inverse() * expected).angle()), kTolerance) << name;
}
void expect_near(const SE3d& found, const SE3l& expected, double size, const char* name) {
  expect_near(found.rotation(), expected.rotation(), name);
  const auto apart = (exact(found).translation() - expected.translation()).norm();
  EXPECT_LT(static_cast<double>(apart), kTolerance * size) << name;
}

/// Entries of a matrix or vector, of which `size` is the largest that rounding refers to.
template <class Found, class Expected>
void expect_near(const Found& found, const Expected& expected, double size) {
  const MatrixXl difference = found.template cast<long double>() - expected;
  EXPECT_LE(static_cast<double>(difference.cwiseAbs().maxCoeff()), kTolerance * size);
}
template <class Matrix>
double size_of(const Matrix& m) {
  return static_cast<double>(m.cwiseAbs().maxCoeff());
}

TEST(Batch, RotationsAreThoseOfSO3) {
  by_every_instruction_set([] {
    const std::vector<Eigen::Vector3d> phi = all_rotation_vectors();
    const std::vector<SO3d> x = rotations();
    const std::vector<SO3d> y = reversed(x);
    std::vector<SO3d> exps(phi.size());
    std::vector<SO3d> products(phi.size());
    std::vector<SO3d> inverses(phi.size());
    std::vector<Eigen::Vector3d> logs(phi.size());
    batch::exp(phi, exps);
    batch::compose(x, y, products);
    batch::inverse(x, inverses);
    batch::log(x, logs);
    for (std::size_t i = 0; i < phi.size(); ++i) {
      SCOPED_TRACE(phi[i].transpose());
      expect_near(exps[i], SO3l::exp(phi[i].cast<long double>()), "Exp");
      expect_near(products[i], exact(x[i]) * exact(y[i]), "product");
      expect_near(inverses[i], exact(x[i]).inverse(), "inverse");
      expect_near(logs[i], exact(x[i]).log(), 1.0);
    }
  });
}

TEST(Batch, JacobiansOfRotationsAreThoseOfSO3) {
  by_every_instruction_set([] {
    const std::vector<Eigen::Vector3d> phi = all_rotation_vectors();
    std::vector<Eigen::Matrix3d> jacobians(phi.size());
    std::vector<Eigen::Matrix3d> inverses(phi.size());
    batch::left_jacobian(phi, jacobians);
    batch::left_jacobian_inverse(phi, inverses);
    for (std::size_t i = 0; i < phi.size(); ++i) {
      SCOPED_TRACE(phi[i].transpose());
      expect_near(jacobians[i], SO3l::left_jacobian(phi[i].cast<long double>()), 1.0);
      const auto inverse = SO3l::left_jacobian_inverse(phi[i].cast<long double>());
      expect_near(inverses[i], inverse, size_of(inverse));
    }
  });
}

TEST(Batch, PosesAreThoseOfSE3) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents();
    const std::vector<SE3d> x = poses();
    const std::vector<SE3d> y = reversed(x);
    std::vector<SE3d> exps(xi.size());
    std::vector<SE3d> products(xi.size());
    std::vector<SE3d> inverses(xi.size());
    std::vector<Vector6d> logs(xi.size());
    batch::exp(xi, exps);
    batch::compose(x, y, products);
    batch::inverse(x, inverses);
    batch::log(x, logs);
    for (std::size_t i = 0; i < xi.size(); ++i) {
      SCOPED_TRACE(xi[i].transpose());
      expect_near(exps[i], SE3l::exp(xi[i].cast<long double>()), xi[i].tail<3>().norm(), "Exp");
      const double far = x[i].translation().norm();
      expect_near(products[i], exact(x[i]) * exact(y[i]), far + y[i].translation().norm(),
                  "product");
      expect_near(inverses[i], exact(x[i]).inverse(), far, "inverse");
      const SE3l::Tangent log = exact(x[i]).log();
      expect_near(logs[i].head<3>(), log.head<3>(), 1.0);
      expect_near(logs[i].tail<3>(), log.tail<3>(), static_cast<double>(log.tail<3>().norm()));
    }
  });
}

TEST(Batch, JacobiansOfPosesAreThoseOfSE3) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents();
    std::vector<Matrix6d> jacobians(xi.size());
    std::vector<Matrix6d> inverses(xi.size());
    std::vector<TwistMatrix<double>> jacobian_blocks(xi.size());
    std::vector<TwistMatrix<double>> inverse_blocks(xi.size());
    batch::left_jacobian(xi, jacobians);
    batch::left_jacobian_inverse(xi, inverses);
    batch::left_jacobian(xi, jacobian_blocks);
    batch::left_jacobian_inverse(xi, inverse_blocks);
    for (std::size_t i = 0; i < xi.size(); ++i) {
      SCOPED_TRACE(xi[i].transpose());
      const MatrixXl jacobian = SE3l::left_jacobian(xi[i].cast<long double>());
      const MatrixXl inverse = SE3l::left_jacobian_inverse(xi[i].cast<long double>());
      expect_near(jacobians[i], jacobian, size_of(jacobian));
      expect_near(inverses[i], inverse, size_of(inverse));
      EXPECT_EQ(jacobian_blocks[i].dense(), jacobians[i]);
      EXPECT_EQ(inverse_blocks[i].dense(), inverses[i]);
    }
  });
}

/// The size of rounding in Ad(X) P Ad(X)^T.
double congruence_size(const SE3d& x, const Matrix6d& p) {
  const double far = 1.0 + x.translation().norm();
  return far * far * size_of(p);
}

TEST(Batch, CovariancesOfPosesAreThoseOfSE3) {
  by_every_instruction_set([] {
    const std::vector<SE3d> x = poses();
    const std::vector<SE3d> y = reversed(x);
    const std::vector<Matrix6d> p = covariances(1);
    const std::vector<Matrix6d> q = covariances(2);
    const std::size_t n = x.size();
    std::vector<SE3d> products(n), betweens(n), inverses(n);
    std::vector<Matrix6d> moved(n), product_p(n), between_p(n), inverse_p(n);
    batch::adjoint_congruence(x, p, moved);
    batch::compose({x, p}, {y, q}, {products, product_p});
    batch::between({x, p}, {y, q}, {betweens, between_p});
    batch::inverse({x, p}, {inverses, inverse_p});
    for (std::size_t i = 0; i < n; ++i) {
      SCOPED_TRACE(x[i].matrix());
      const MatrixXl p_i = p[i].cast<long double>();
      const MatrixXl q_i = q[i].cast<long double>();
      const SE3l back = exact(x[i]).inverse();
      const double far = x[i].translation().norm() + y[i].translation().norm();
      const double size = congruence_size(x[i], p[i]) + congruence_size(x[i], q[i]);
      expect_near(moved[i], exact(x[i]).adjoint_congruence(p_i), size);
      EXPECT_EQ(moved[i], moved[i].transpose());
      expect_near(products[i], exact(x[i]) * exact(y[i]), far, "product");
      expect_near(product_p[i], p_i + exact(x[i]).adjoint_congruence(q_i), size);
      expect_near(betweens[i], back * exact(y[i]), far, "between");
      expect_near(between_p[i], back.adjoint_congruence(p_i + q_i), size);
      expect_near(inverses[i], back, far, "inverse");
      expect_near(inverse_p[i], back.adjoint_congruence(p_i), size);
    }
  });
}

}  // namespace
}  // namespace posemix
