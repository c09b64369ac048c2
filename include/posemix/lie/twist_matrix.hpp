// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "posemix/base/linear.hpp"

namespace posemix {

/// d I + w^ + p q^T + q p^T, the form of every 3x3 block of a Jacobian. The entries are written out
/// so that the compiler keeps them in registers.
template <typename Scalar>
Eigen::Matrix<Scalar, 3, 3> hat_plus_symmetric(const Scalar& d,
                                               const Eigen::Matrix<Scalar, 3, 1>& w,
                                               const Eigen::Matrix<Scalar, 3, 1>& p,
                                               const Eigen::Matrix<Scalar, 3, 1>& q) {
  const Scalar xy = p.x() * q.y() + p.y() * q.x();
  const Scalar xz = p.x() * q.z() + p.z() * q.x();
  const Scalar yz = p.y() * q.z() + p.z() * q.y();
  Eigen::Matrix<Scalar, 3, 3> m;
  m << d + Scalar(2) * p.x() * q.x(), xy - w.z(), xz + w.y(),  //
      xy + w.z(), d + Scalar(2) * p.y() * q.y(), yz - w.x(),   //
      xz - w.y(), yz + w.x(), d + Scalar(2) * p.z() * q.z();
  return m;
}

/// The 6x6 matrix [a 0; b a] in tangent order [phi; rho], the form of every Adjoint and Jacobian of
/// SE(3).
template <typename Scalar>
struct TwistMatrix {
  using Block = Eigen::Matrix<Scalar, 3, 3>;
  using Dense = Eigen::Matrix<Scalar, 6, 6>;
  using Tangent = Eigen::Matrix<Scalar, 6, 1>;

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

  /// The product of two such matrices, computed by three 3x3 products.
  TwistMatrix operator*(const TwistMatrix& right) const {
    return {a * right.a, b * right.a + a * right.b};
  }

  /// this * p * right^T for a 6x6 block p, computed by twelve 3x3 products.
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

  /// this * p * this^T for a symmetric p; the result is exactly symmetric. With doubles the vector
  /// instructions of the machine are used.
  Dense congruence(const Dense& p) const { return congruence_by_products(p); }

  /// The same by eight 3x3 products, on every machine to the same bit: the reference.
  Dense congruence_by_products(const Dense& p) const {
    const Block left = p.template topLeftCorner<3, 3>() * a.transpose();
    const Columns right = times_b_a_transpose(p);
    Dense m;
    m.template topLeftCorner<3, 3>() = a.lazyProduct(left);
    m.template topRightCorner<3, 3>() = a.lazyProduct(right.template topRows<3>());
    m.template bottomRightCorner<3, 3>() =
        b.lazyProduct(right.template topRows<3>()) + a.lazyProduct(right.template bottomRows<3>());
    mirror_upper_in_place(m);
    return m;
  }

  /// this * p.
  Dense times(const Dense& p) const {
    Dense m;
    m.template topRows<3>() = a.lazyProduct(p.template topRows<3>());
    m.template bottomRows<3>() =
        b.lazyProduct(p.template topRows<3>()) + a.lazyProduct(p.template bottomRows<3>());
    return m;
  }

  Tangent times(const Tangent& x) const {
    Tangent y;
    y.template head<3>() = a * x.template head<3>();
    y.template tail<3>() = b * x.template head<3>() + a * x.template tail<3>();
    return y;
  }

  /// this^T * x.
  Tangent transpose_times(const Tangent& x) const {
    Tangent y;
    y.template head<3>() =
        a.transpose() * x.template head<3>() + b.transpose() * x.template tail<3>();
    y.template tail<3>() = a.transpose() * x.template tail<3>();
    return y;
  }

  /// p * this^T.
  Dense transpose_after(const Dense& p) const {
    Dense m;
    m.template leftCols<3>() = p.template leftCols<3>().lazyProduct(a.transpose());
    m.template rightCols<3>() = times_b_a_transpose(p);
    return m;
  }

 private:
  using Columns = Eigen::Matrix<Scalar, 6, 3>;

  /// The last three columns of p * this^T. Lazy products are fused into one loop without
  /// temporaries.
  Columns times_b_a_transpose(const Dense& p) const {
    return p.template leftCols<3>().lazyProduct(b.transpose()) +
           p.template rightCols<3>().lazyProduct(a.transpose());
  }
};

template <>
TwistMatrix<double>::Dense TwistMatrix<double>::congruence(const Dense& p) const;

}  // namespace posemix
