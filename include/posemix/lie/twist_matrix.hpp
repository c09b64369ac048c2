// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

namespace posemix {

/// `m` with its strict lower triangle replaced by the mirrored upper one.
template <typename Derived>
typename Derived::PlainObject mirror_upper(const Eigen::MatrixBase<Derived>& m) {
  typename Derived::PlainObject full = m;
  full.template triangularView<Eigen::StrictlyLower>() = full.transpose();
  return full;
}

/// The 6x6 matrix [a 0; b a] in tangent order [phi; rho]: the shape of every Adjoint and Jacobian
/// of SE(3).
template <typename Scalar>
struct TwistMatrix {
  using Block = Eigen::Matrix<Scalar, 3, 3>;
  using Dense = Eigen::Matrix<Scalar, 6, 6>;

  Block a;
  Block b;

  Dense dense() const {
    Dense m;
    m.template topLeftCorner<3, 3>() = a;
    m.template topRightCorner<3, 3>().setZero();
    m.template bottomLeftCorner<3, 3>() = b;
    m.template bottomRightCorner<3, 3>() = a;
    return m;
  }

  /// this * p * right^T for a 6x6 block p, in twelve 3x3 products.
  Dense sandwich(const Dense& p, const TwistMatrix& right) const {
    const Block p11 = p.template topLeftCorner<3, 3>();
    const Block p12 = p.template topRightCorner<3, 3>();
    const Block m11 = a * p11;
    const Block m12 = a * p12;
    const Block m21 = b * p11 + a * p.template bottomLeftCorner<3, 3>();
    const Block m22 = b * p12 + a * p.template bottomRightCorner<3, 3>();
    Dense m;
    m.template topLeftCorner<3, 3>() = m11 * right.a.transpose();
    m.template topRightCorner<3, 3>() = m11 * right.b.transpose() + m12 * right.a.transpose();
    m.template bottomLeftCorner<3, 3>() = m21 * right.a.transpose();
    m.template bottomRightCorner<3, 3>() = m21 * right.b.transpose() + m22 * right.a.transpose();
    return m;
  }

  /// this * p * this^T for a symmetric p; the result is exactly symmetric.
  Dense congruence(const Dense& p) const { return mirror_upper(sandwich(p, *this)); }
};

}  // namespace posemix
