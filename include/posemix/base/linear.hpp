// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "posemix/base/error.hpp"

/// Small linear algebra that every room shares.
namespace posemix {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

inline constexpr double kLogTwoPi = 1.8378770664093454835606594728112;

/// Replaces `matrix` by its symmetric part, in place.
template <class Derived>
void symmetrize(Eigen::MatrixBase<Derived>& matrix) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (Eigen::Index row = 0; row < column; ++row) {
      const auto mean = 0.5 * (matrix(row, column) + matrix(column, row));
      matrix(row, column) = mean;
      matrix(column, row) = mean;
    }
  }
}

/// Replaces the strict lower triangle of the square matrix `m` by the mirrored upper one.
template <typename Derived>
void mirror_upper_in_place(Eigen::MatrixBase<Derived>& m) {
  for (Eigen::Index column = 0; column < m.cols(); ++column) {
    for (Eigen::Index row = column + 1; row < m.rows(); ++row) m(row, column) = m(column, row);
  }
}

/// `m` with its strict lower triangle replaced by the mirrored upper one.
template <typename Derived>
typename Derived::PlainObject mirror_upper(const Eigen::MatrixBase<Derived>& m) {
  typename Derived::PlainObject full = m;
  mirror_upper_in_place(full);
  return full;
}

/// log det of the matrix with this Cholesky factor.
template <class Matrix>
double log_det(const Eigen::LLT<Matrix>& factor) {
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

/// log N(residual; 0, S) for the Cholesky factor of the covariance S.
template <class Matrix, class Vector>
double log_normal(const Eigen::LLT<Matrix>& factor, const Eigen::MatrixBase<Vector>& residual) {
  const double squared = factor.matrixL().solve(residual).squaredNorm();
  return -0.5 * (squared + log_det(factor) + static_cast<double>(residual.size()) * kLogTwoPi);
}

/// Checks a covariance and returns its symmetric part. It must be square of the given size, finite,
/// symmetric up to rounding (1e-9 of its largest entry) and positive definite. `name` begins the
/// error message.
/// @throws InvalidInput naming the property that fails
template <class Matrix>
Matrix checked_covariance(const Matrix& covariance, Eigen::Index size, const std::string& name) {
  if (covariance.rows() != size || covariance.cols() != size) {
    throw InvalidInput(fmt::format("{} is {} x {}, expected {} x {}", name, covariance.rows(),
                                   covariance.cols(), size, size));
  }
  if (!covariance.allFinite()) throw InvalidInput(name + " holds a value that is not finite");
  const double largest = size == 0 ? 0.0 : covariance.cwiseAbs().maxCoeff();
  if (size > 0 && (covariance - covariance.transpose()).cwiseAbs().maxCoeff() > 1e-9 * largest) {
    throw InvalidInput(name + " is not symmetric");
  }
  Matrix symmetric = covariance;
  symmetrize(symmetric);
  if (Eigen::LLT<Matrix>(symmetric).info() != Eigen::Success) {
    throw InvalidInput(name + " is not positive definite");
  }
  return symmetric;
}

/// Instantiates the functions above once for N x N matrices, so that the files that use them do
/// not.
// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_LINEAR(prefix, N)                                                           \
  prefix template double log_normal(const Eigen::LLT<Eigen::Matrix<double, N, N>>&,         \
                                    const Eigen::MatrixBase<Eigen::Matrix<double, N, 1>>&); \
  prefix template Eigen::Matrix<double, N, N> checked_covariance(                           \
      const Eigen::Matrix<double, N, N>&, Eigen::Index, const std::string&)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_LINEAR(extern, 3);
POSEMIX_LINEAR(extern, 6);
POSEMIX_LINEAR(extern, Eigen::Dynamic);

}  // namespace posemix
