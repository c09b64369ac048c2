// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "lie/pose_kernels.hpp"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/every_instruction_set.hpp"
#include "lie/stack_kernels.hpp"
#include "posemix/base/random.hpp"

// Oracle: the templates of SE3 and PoseStack in long double.
namespace posemix::internal {
namespace {

using SE3l = SE3<long double>;
using Tangentl = SE3l::Tangent;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

constexpr double kKernelTolerance = 1e-13;

/// Angles of zero, tiny ones, on both sides of where the series end, near pi and beyond it.
std::vector<Vector6d> tangents() {
  RandomStream stream(5);
  std::vector<Vector6d> result;
  for (const double angle : {0.0, 1e-160, 1e-9, 1e-3, 0.1, 0.5, 1.0, 1.9999, 2.0, 2.0001, 3.0,
                             std::numbers::pi - 1e-9, 3.9999, 4.0, 4.5, 6.0, 9.0}) {
    for (int k = 0; k < 3; ++k) {
      Vector6d xi;
      for (double& x : xi) x = stream.normal();
      xi.head<3>() *= angle / xi.head<3>().norm();
      result.push_back(xi);
    }
  }
  return result;
}

/// Of angles below pi.
std::vector<Vector6d> near_tangents() {
  std::vector<Vector6d> result;
  for (const Vector6d& xi : tangents()) {
    if (xi.head<3>().norm() < std::numbers::pi) result.push_back(xi);
  }
  return result;
}

std::vector<SE3d> poses() {
  std::vector<SE3d> result;
  for (const Vector6d& xi : near_tangents()) result.push_back(SE3d::exp(xi));
  return result;
}

ConstRows rows(const std::vector<Vector6d>& xi) { return {xi.data()->data(), 6}; }

SE3l exact(const SE3d& pose) {
  return SE3l(pose.rotation().cast<long double>(), pose.translation().cast<long double>());
}

double error(const SE3d& pose, const SE3l& expected) {
  const auto rotation = (exact(pose).rotation().inverse() * expected.rotation()).angle();
  const auto apart = (exact(pose).translation() - expected.translation()).norm();
  return static_cast<double>(std::max(rotation, apart / (1.0L + expected.translation().norm())));
}

TEST(PoseKernels, ExpIsThatOfSE3) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents();
    std::vector<SE3d> found(xi.size());
    exp_of(rows(xi), rows_of(found.data()), xi.size());
    for (std::size_t i = 0; i < xi.size(); ++i)
      EXPECT_LT(error(found[i], SE3l::exp(xi[i].cast<long double>())), 1e-14) << xi[i].transpose();
  });
}

TEST(PoseKernels, LogIsThatOfSE3) {
  by_every_instruction_set([] {
    const std::vector<SE3d> given = poses();
    std::vector<Vector6d> found(given.size());
    log_of(rows_of(given.data()), {found.data()->data(), 6}, given.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
      const Tangentl expected = exact(given[i]).log();
      const double size = static_cast<double>(1.0L + expected.norm());
      EXPECT_LT((found[i] - expected.cast<double>()).norm(), 1e-14 * size) << i;
    }
  });
}

TEST(PoseKernels, LogOfHalfATurnHasTheSignOfSE3) {
  by_every_instruction_set([] {
    for (const Eigen::Vector4d& q :
         {Eigen::Vector4d(1, 0, 0, 0), Eigen::Vector4d(-1, 0, 0, 0), Eigen::Vector4d(0, -1, 0, 0),
          Eigen::Vector4d(0, 0, -1, 0), Eigen::Vector4d(-0.6, 0.8, 0, -0.0)}) {
      const SE3d pose(SO3d::from_quaternion(Eigen::Quaterniond(q)), {1.0, 2.0, 3.0});
      Vector6d found;
      log_of(rows_of(&pose), {found.data(), 6}, 1);
      EXPECT_LT((found - pose.log()).norm(), 1e-14) << q.transpose();
    }
  });
}

TEST(PoseKernels, ProductsAndQuotientsAreThoseOfSE3) {
  by_every_instruction_set([] {
    const std::vector<SE3d> x = poses();
    const std::vector<SE3d> y(x.rbegin(), x.rend());
    std::vector<SE3d> found(x.size());
    product_of(rows_of(x.data()), rows_of(y.data()), rows_of(found.data()), x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_LT(error(found[i], exact(x[i]) * exact(y[i])), 1e-14) << i;
    quotient_of(rows_of(x.data()), rows_of(y.data()), rows_of(found.data()), x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_LT(error(found[i], exact(x[i]) * exact(y[i]).inverse()), 1e-14) << i;
  });
}

TEST(PoseKernels, ExpTimesAPose) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents();
    std::vector<SE3d> x;
    for (std::size_t i = 0; i < xi.size(); ++i) x.push_back(poses()[i % poses().size()]);
    std::vector<SE3d> found(xi.size());
    exp_product_of(rows(xi), rows_of(std::as_const(x).data()), rows_of(found.data()), xi.size());
    for (std::size_t i = 0; i < xi.size(); ++i) {
      EXPECT_LT(error(found[i], SE3l::exp(xi[i].cast<long double>()) * exact(x[i])), 1e-14)
          << xi[i].transpose();
    }
  });
}

TEST(PoseKernels, ResidualsOfDetections) {
  by_every_instruction_set([] {
    const std::vector<SE3d> y = poses();
    const std::vector<SE3d> z(y.rbegin(), y.rend());
    const SE3d x = SE3d::exp((Vector6d() << 0.3, -0.2, 0.5, 1.0, 2.0, -3.0).finished());
    std::vector<Vector6d> found(y.size());
    residual_of(x, rows_of(y.data()), rows_of(z.data()), {found.data()->data(), 6}, y.size());
    for (std::size_t i = 0; i < y.size(); ++i) {
      const Tangentl expected = (exact(x) * exact(y[i]) * exact(z[i]).inverse()).log();
      const double size = static_cast<double>(1.0L + expected.norm());
      EXPECT_LT((found[i] - expected.cast<double>()).norm(), 1e-13 * size) << i;
    }
  });
}

/// By Adjoints and Jacobians, also of poses far away.
std::vector<TwistMatrix<double>> twist_matrices() {
  std::vector<TwistMatrix<double>> result;
  for (const SE3d& x : poses()) result.push_back(x.adjoint_blocks());
  for (const Vector6d& xi : tangents()) result.push_back(SE3d::left_jacobian_inverse_blocks(xi));
  result.push_back(SE3d(SO3d::exp({1, -2, 0.5}), {1e6, -1e5, 1e-3}).adjoint_blocks());
  return result;
}

TEST(PoseKernels, CongruencesOfOneMatrix) {
  by_every_instruction_set([] {
    RandomStream stream(9);
    for (const TwistMatrix<double>& w : twist_matrices()) {
      Matrix6d root;
      for (double& entry : root.reshaped()) entry = stream.normal();
      const Matrix6d p = root * root.transpose();
      const Matrix6d found = w.congruence(p);
      const MatrixXl l = w.dense().cast<long double>();
      const MatrixXl expected = l * p.cast<long double>() * l.transpose();
      const double size = static_cast<double>(
          (l.cwiseAbs() * p.cwiseAbs().cast<long double>() * l.transpose().cwiseAbs()).maxCoeff());
      const double difference =
          static_cast<double>((found.cast<long double>() - expected).cwiseAbs().maxCoeff());
      EXPECT_LE(difference, 1e-15 * size);
      EXPECT_LE((found - w.congruence_by_products(p)).cwiseAbs().maxCoeff(), 2e-15 * size);
      EXPECT_EQ(found, found.transpose());
    }
  });
}

TEST(PoseKernels, CongruencesWithAdjoints) {
  by_every_instruction_set([] {
    RandomStream stream(8);
    const std::vector<SE3d> x = poses();
    std::vector<Matrix6d> p(x.size());
    for (Matrix6d& one : p) {
      Matrix6d root;
      for (double& entry : root.reshaped()) entry = stream.normal();
      one = root * root.transpose();
    }
    // In place, as filters use it.
    std::vector<Matrix6d> found = p;
    adjoint_congruence_of(rows_of(x.data()), {found.data()->data(), 36}, {found.data()->data(), 36},
                          x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const MatrixXl expected = exact(x[i]).adjoint_congruence(p[i].cast<long double>());
      const MatrixXl difference = found[i].cast<long double>() - expected;
      EXPECT_LT(static_cast<double>(difference.cwiseAbs().maxCoeff()),
                1e-14 * static_cast<double>(expected.cwiseAbs().maxCoeff()))
          << i;
      EXPECT_EQ(found[i], found[i].transpose()) << i;
    }
  });
}

template <class Exact>
void expect_blocks(const std::vector<TwistMatrix<double>>& found, const std::vector<Vector6d>& xi,
                   const Exact& exact_blocks) {
  for (std::size_t i = 0; i < xi.size(); ++i) {
    const TwistMatrix<long double> expected = exact_blocks(xi[i].cast<long double>());
    const double size = static_cast<double>(expected.dense().cwiseAbs().maxCoeff());
    const MatrixXl difference = found[i].dense().cast<long double>() - expected.dense();
    EXPECT_LT(static_cast<double>(difference.cwiseAbs().maxCoeff()), kKernelTolerance * size)
        << xi[i].transpose();
  }
}

TEST(PoseKernels, JacobiansAreThoseOfSE3) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents();
    std::vector<TwistMatrix<double>> found(xi.size());
    left_jacobian_blocks_of(rows(xi), {found.data()->a.data(), 18}, xi.size());
    expect_blocks(found, xi, &SE3l::left_jacobian_blocks);
    left_jacobian_inverse_blocks_of(rows(xi), {found.data()->a.data(), 18}, xi.size());
    expect_blocks(found, xi, &SE3l::left_jacobian_inverse_blocks);
  });
}

TEST(PoseKernels, AResultDoesNotDependOnTheOthers) {
  by_every_instruction_set([] {
    const std::vector<Vector6d> xi = tangents();
    std::vector<SE3d> all(xi.size());
    exp_of(rows(xi), rows_of(all.data()), xi.size());
    std::vector<TwistMatrix<double>> blocks(xi.size());
    left_jacobian_inverse_blocks_of(rows(xi), {blocks.data()->a.data(), 18}, xi.size());
    for (std::size_t i = 0; i < xi.size(); ++i) {
      SE3d one;
      exp_of({xi[i].data(), 6}, rows_of(&one), 1);
      EXPECT_EQ(one.matrix(), all[i].matrix()) << i;
      TwistMatrix<double> block;
      left_jacobian_inverse_blocks_of({xi[i].data(), 6}, {block.a.data(), 18}, 1);
      EXPECT_EQ(block.dense(), blocks[i].dense()) << i;
    }
  });
}

TEST(StackKernels, ASumOfCongruencesIsThatOfStacks) {
  by_every_instruction_set([] {
    RandomStream stream(9);
    const std::vector<Vector6d> near = near_tangents();
    for (const std::size_t size : {1u, 2u, 3u, 6u, 11u}) {
      const auto n = static_cast<Eigen::Index>(6 * size);
      Eigen::MatrixXd d(n, 2);
      for (double& x : d.reshaped()) x = stream.normal();
      MatrixXl expected = d.cast<long double>() * d.cast<long double>().transpose();
      std::vector<std::vector<TwistMatrix<double>>> blocks(3);
      std::vector<Eigen::MatrixXd> p(3);
      std::vector<Congruence> parts;
      for (std::size_t k = 0; k < 3; ++k) {
        Eigen::Matrix<long double, Eigen::Dynamic, 1> xi(n);
        for (std::size_t i = 0; i < size; ++i) {
          const Vector6d& one = near[(7 * i + 3 * k) % near.size()];
          blocks[k].push_back(SE3d::left_jacobian_blocks(one));
          xi.segment<6>(6 * static_cast<Eigen::Index>(i)) = one.cast<long double>();
        }
        Eigen::MatrixXd root(n, n);
        for (double& x : root.reshaped()) x = stream.normal();
        p[k] = root * root.transpose();
        const double weight = 0.2 + 0.3 * static_cast<double>(k);
        expected +=
            weight * PoseStack<long double>::left_jacobian_congruence(xi, p[k].cast<long double>());
        parts.push_back({blocks[k].data(), &p[k], weight});
      }
      Eigen::MatrixXd sum(n, n);
      sum_congruences(parts, d, sum);
      const MatrixXl difference = sum.cast<long double>() - expected;
      EXPECT_LT(static_cast<double>(difference.cwiseAbs().maxCoeff()),
                kKernelTolerance * static_cast<double>(expected.cwiseAbs().maxCoeff()))
          << size;
      EXPECT_EQ(sum, sum.transpose()) << size;
    }
  });
}

}  // namespace
}  // namespace posemix::internal
