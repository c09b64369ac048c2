// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include <Eigen/Core>

/// References in 100-digit arithmetic that share no formula with the library: Exp is the power
/// series of the matrix exponential (scaling and squaring), J_l the power series sum ad^n / (n+1)!,
/// its inverse an LU solve, and Log the half-angle formula of a quaternion. The matrices ad and hat
/// are written out from their definitions. Tangent vectors have three (SO(3)) or six entries
/// (SE(3)).
namespace posemix::oracle {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                           boost::multiprecision::et_off>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

template <typename Derived>
Matrix raise(const Eigen::MatrixBase<Derived>& m) {
  return m.template cast<Real>();
}

template <typename Scalar>
Matrix as_matrix(const Scalar& value) {
  return Matrix::Constant(1, 1, Real(value));
}

/// The skew-symmetric matrix of a vector product.
Matrix cross(const Vector& v);

/// a b.
Matrix product(const Matrix& a, const Matrix& b);

/// Homogeneous matrix: 3x3 of a rotation vector, 4x4 of a twist.
Matrix exp(const Vector& xi);

Matrix left_jacobian(const Vector& xi);

Matrix inverse(const Matrix& m);

Real log_abs_det(const Matrix& m);

/// Rotation matrix of q / |q|, q = (x, y, z, w).
Matrix rotation(const Vector& q);

/// Rotation vector of q / |q|, of norm at most pi; at exactly pi, the one of the two whose first
/// non-zero entry is positive.
Vector log(const Vector& q);

/// The twist of (q, t): the translation part solves J_l(phi) rho = t.
Vector log(const Vector& q, const Vector& t);

}  // namespace posemix::oracle
