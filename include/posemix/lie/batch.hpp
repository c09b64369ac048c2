// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

/// Functions of many rotations or poses at once, by the widest vector instructions of the machine.
/// The functions of SO3 and SE3 with these names are the reference: for angles up to pi values
/// agree to 1e-13 of their size, for larger ones to as many digits less as the angle has before its
/// point, and J_l^-1 less near 2 pi, where it is singular. What is not a number makes its result
/// not a number, without an exception.
///
/// A result has as many items as the arguments, and may be one of them. `threads` threads work on
/// it, 0 for one per core; the bits are the same for any number.
/// @throws InvalidInput when the numbers of items differ
namespace posemix::batch {

/// Exp of tangent vectors [rad], or [rad, m].
void exp(std::span<const Eigen::Vector3d> phi, std::span<SO3d> result, std::size_t threads = 1);
void exp(std::span<const Vector6d> xi, std::span<SE3d> result, std::size_t threads = 1);

/// The tangent vectors [rad], or [rad, m], of angles up to pi.
void log(std::span<const SO3d> x, std::span<Eigen::Vector3d> result, std::size_t threads = 1);
void log(std::span<const SE3d> x, std::span<Vector6d> result, std::size_t threads = 1);

/// J_l.
void left_jacobian(std::span<const Eigen::Vector3d> phi, std::span<Eigen::Matrix3d> result,
                   std::size_t threads = 1);
void left_jacobian(std::span<const Vector6d> xi, std::span<Matrix6d> result,
                   std::size_t threads = 1);
/// The blocks of J_l.
void left_jacobian(std::span<const Vector6d> xi, std::span<TwistMatrix<double>> result,
                   std::size_t threads = 1);

/// J_l^-1, which is singular at angles 2 pi, 4 pi, ...
void left_jacobian_inverse(std::span<const Eigen::Vector3d> phi, std::span<Eigen::Matrix3d> result,
                           std::size_t threads = 1);
void left_jacobian_inverse(std::span<const Vector6d> xi, std::span<Matrix6d> result,
                           std::size_t threads = 1);
/// The blocks of J_l^-1.
void left_jacobian_inverse(std::span<const Vector6d> xi, std::span<TwistMatrix<double>> result,
                           std::size_t threads = 1);

/// X_i Y_i.
void compose(std::span<const SO3d> x, std::span<const SO3d> y, std::span<SO3d> result,
             std::size_t threads = 1);
void compose(std::span<const SE3d> x, std::span<const SE3d> y, std::span<SE3d> result,
             std::size_t threads = 1);

/// X_i^-1.
void inverse(std::span<const SO3d> x, std::span<SO3d> result, std::size_t threads = 1);
void inverse(std::span<const SE3d> x, std::span<SE3d> result, std::size_t threads = 1);

/// Ad(X_i) P_i Ad(X_i)^T for symmetric P_i, of which one triangle is read; exactly symmetric.
void adjoint_congruence(std::span<const SE3d> x, std::span<const Matrix6d> p,
                        std::span<Matrix6d> result, std::size_t threads = 1);

/// Poses and the covariances of their left perturbations, X = Exp(xi) mean, xi ~ N(0, covariance).
/// The covariances are symmetric; one triangle of them is read.
struct UncertainPoses {
  std::span<const SE3d> mean;
  std::span<const Matrix6d> covariance;
};
struct UncertainPosesResult {
  std::span<SE3d> mean;
  std::span<Matrix6d> covariance;
};

/// X_i Y_i for independent X_i and Y_i to first order (Barfoot and Furgale 2014): the covariances
/// are P_X + Ad(X) P_Y Ad(X)^T.
void compose(const UncertainPoses& x, const UncertainPoses& y, const UncertainPosesResult& result,
             std::size_t threads = 1);
/// X_i^-1 Y_i for independent X_i and Y_i to first order: the covariances are
/// Ad(X^-1) (P_X + P_Y) Ad(X^-1)^T.
void between(const UncertainPoses& x, const UncertainPoses& y, const UncertainPosesResult& result,
             std::size_t threads = 1);
/// X_i^-1: the covariances are Ad(X^-1) P Ad(X^-1)^T. Exact.
void inverse(const UncertainPoses& x, const UncertainPosesResult& result, std::size_t threads = 1);

}  // namespace posemix::batch
