// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "posemix/base/error.hpp"
#include "posemix/lie/small_angle.hpp"
#include "posemix/lie/so3.hpp"
#include "posemix/lie/twist_matrix.hpp"

namespace posemix {

/// Rigid motions of three-space, T = (R, t). Tangent: [phi; rho], the rotation vector [rad] first,
/// then metres.
///
/// Invariants: those of SO3 for the rotation; the last row of matrix() is exactly 0 0 0 1.
///
/// Every Adjoint and Jacobian is a block matrix [a 0; b a]. In a Jacobian, a is the Jacobian of SO3
/// at phi, and b is its directional derivative along rho. That derivative follows from J(phi + eps
/// rho) with rho as a dual number, so no separate "Q block" is needed.
template <typename S>
class SE3 {
 public:
  using Scalar = S;
  static constexpr int Dof = 6;
  using Tangent = Eigen::Matrix<Scalar, 6, 1>;
  using TangentMatrix = Eigen::Matrix<Scalar, 6, 6>;
  using Matrix = Eigen::Matrix<Scalar, 4, 4>;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  using Rotation = SO3<Scalar>;
  using Blocks = TwistMatrix<Scalar>;

  /// The identity.
  SE3() : translation_(Vector3::Zero()) {}
  /// The motion p -> rotation * p + translation [m].
  SE3(const Rotation& rotation, const Vector3& translation)
      : rotation_(rotation), translation_(translation) {}

  /// The motion of a homogeneous 4x4 matrix.
  /// @throws InvalidInput when the upper left block is not a rotation to `tol` (see
  /// SO3::from_matrix), an entry is not finite, or the last row differs from 0 0 0 1 by more than
  /// `tol`
  static SE3 from_matrix(const Matrix& m, const Scalar& tol = Scalar(1e-6));

  static SE3 exp(const Tangent& xi);
  /// The tangent vector [phi; rho] [rad, m], with |phi| at most pi.
  Tangent log() const;

  const Rotation& rotation() const { return rotation_; }
  const Vector3& translation() const { return translation_; }
  Matrix matrix() const;

  SE3 operator*(const SE3& other) const {
    return SE3(rotation_ * other.rotation_, rotation_ * other.translation_ + translation_);
  }
  /// The transformed point `p` [m].
  Vector3 operator*(const Vector3& p) const { return rotation_ * p + translation_; }

  SE3 inverse() const {
    const Rotation back = rotation_.inverse();
    return SE3(back, -(back * translation_));
  }
  static SE3 identity() { return SE3(); }
  static Eigen::Index dof() { return Dof; }

  /// The blocks of Ad = [R 0; t^ R R].
  Blocks adjoint_blocks() const {
    Blocks m{rotation_.matrix(), {}};
    const Vector3& t = translation_;
    for (Eigen::Index j = 0; j < 3; ++j) {
      m.b(0, j) = t.y() * m.a(2, j) - t.z() * m.a(1, j);
      m.b(1, j) = t.z() * m.a(0, j) - t.x() * m.a(2, j);
      m.b(2, j) = t.x() * m.a(1, j) - t.y() * m.a(0, j);
    }
    return m;
  }
  TangentMatrix adjoint() const;
  /// Ad P Ad^T for a symmetric P.
  TangentMatrix adjoint_congruence(const TangentMatrix& p) const;

  /// The 4x4 matrix [phi^ rho; 0 0].
  static Matrix hat(const Tangent& xi);
  /// The inverse of hat; phi is read from the skew-symmetric part of the upper left block.
  static Tangent vee(const Matrix& m);
  /// [phi^ 0; rho^ phi^].
  static TangentMatrix ad(const Tangent& xi);

  /// The blocks of J_l(xi).
  static Blocks left_jacobian_blocks(const Tangent& xi);
  /// The blocks of J_l^-1(xi), which is singular at |phi| = 2 pi, 4 pi, ...
  static Blocks left_jacobian_inverse_blocks(const Tangent& xi);

  static TangentMatrix left_jacobian(const Tangent& xi);
  static TangentMatrix left_jacobian_inverse(const Tangent& xi);
  static TangentMatrix right_jacobian(const Tangent& xi) { return left_jacobian(-xi); }
  static TangentMatrix right_jacobian_inverse(const Tangent& xi) {
    return left_jacobian_inverse(-xi);
  }

  /// log |det J_l|, twice the value of SO3 at phi.
  static Scalar log_abs_det_left_jacobian(const Tangent& xi) {
    return Scalar(2) * Rotation::log_abs_det_left_jacobian(xi.template head<3>());
  }
  /// J_l P J_l^T for a symmetric P.
  static TangentMatrix left_jacobian_congruence(const Tangent& xi, const TangentMatrix& p);
  /// J_l^-1 P J_l^-T for a symmetric P.
  static TangentMatrix left_jacobian_inverse_congruence(const Tangent& xi, const TangentMatrix& p);

  /// Whether the rotations differ by at most `tol` rad and the translations by at most `tol`
  /// metres.
  bool is_approx(const SE3& other, const Scalar& tol) const;

  template <typename Other>
  SE3<Other> cast() const {
    return SE3<Other>(rotation_.template cast<Other>(), translation_.template cast<Other>());
  }

 private:
  Rotation rotation_;
  Vector3 translation_;
};

template <typename S>
SE3<S> SE3<S>::from_matrix(const Matrix& m, const Scalar& tol) {
  if (!m.allFinite()) throw InvalidInput("pose matrix has an entry that is not finite");
  Eigen::Matrix<Scalar, 1, 4> last_row;
  last_row << Scalar(0), Scalar(0), Scalar(0), Scalar(1);
  if (!((m.row(3) - last_row).cwiseAbs().maxCoeff() <= tol)) {
    throw InvalidInput("last row of a pose matrix is not 0 0 0 1");
  }
  return SE3(Rotation::from_matrix(m.template topLeftCorner<3, 3>(), tol),
             m.template topRightCorner<3, 1>());
}

template <typename S>
SE3<S> SE3<S>::exp(const Tangent& xi) {
  const Vector3 phi = xi.template head<3>();
  const Vector3 rho = xi.template tail<3>();
  const Scalar u = phi.squaredNorm();
  const auto half = small_angle::cosine_and_sinc(Scalar(u / Scalar(4)));
  // J_l rho = A rho + B phi x rho + C phi phi^T rho by double-angle formulas. Cancellation
  // in 1 - A leaves an error of the size of rounding in A rho, whatever the angle.
  const Scalar a = half.sinc * half.cosine;
  const Scalar b = half.sinc * half.sinc / Scalar(2);
  const Scalar c = u > Scalar(0) ? Scalar((Scalar(1) - a) / u) : Scalar(0);
  const Vector3 translation = a * rho + b * phi.cross(rho) + (c * phi.dot(rho)) * phi;
  return SE3(Rotation::of_half_angle(half, phi), translation);
}

template <typename S>
typename SE3<S>::Tangent SE3<S>::log() const {
  // J_l^-1 = h cot h I - ratio v^ + outer v v^T, from the half angle h of the quaternion.
  const typename Rotation::HalfAngle half = rotation_.half_angle();
  const Vector3& t = translation_;
  Tangent xi;
  xi.template head<3>() = (Scalar(2) * half.ratio) * half.v;
  xi.template tail<3>() = (half.ratio * half.w) * t - half.ratio * half.v.cross(t) +
                          (half.outer * half.v.dot(t)) * half.v;
  return xi;
}

template <typename S>
typename SE3<S>::Matrix SE3<S>::matrix() const {
  Matrix m = Matrix::Identity();
  m.template topLeftCorner<3, 3>() = rotation_.matrix();
  m.template topRightCorner<3, 1>() = translation_;
  return m;
}

template <typename S>
typename SE3<S>::Matrix SE3<S>::hat(const Tangent& xi) {
  Matrix m = Matrix::Zero();
  m.template topLeftCorner<3, 3>() = Rotation::hat(xi.template head<3>());
  m.template topRightCorner<3, 1>() = xi.template tail<3>();
  return m;
}

template <typename S>
typename SE3<S>::Tangent SE3<S>::vee(const Matrix& m) {
  Tangent xi;
  xi.template head<3>() = Rotation::vee(m.template topLeftCorner<3, 3>());
  xi.template tail<3>() = m.template topRightCorner<3, 1>();
  return xi;
}

template <typename S>
TwistMatrix<S> SE3<S>::left_jacobian_blocks(const Tangent& xi) {
  const Vector3 phi = xi.template head<3>();
  const Vector3 rho = xi.template tail<3>();
  const Scalar u = phi.squaredNorm();
  const auto c = small_angle::jacobian_coefficients(u);
  const auto slope = small_angle::jacobian_coefficient_slopes(u, c);
  const Scalar du = Scalar(2) * phi.dot(rho);
  return {hat_plus_symmetric<Scalar>(c.a, c.b * phi, phi, (c.c / Scalar(2)) * phi),
          hat_plus_symmetric<Scalar>(du * slope.a, c.b * rho + (du * slope.b) * phi, phi,
                                     c.c * rho + (du * slope.c / Scalar(2)) * phi)};
}

template <typename S>
TwistMatrix<S> SE3<S>::left_jacobian_inverse_blocks(const Tangent& xi) {
  const Vector3 phi = xi.template head<3>();
  const Vector3 rho = xi.template tail<3>();
  const Scalar u = phi.squaredNorm();
  const auto c = small_angle::inverse_jacobian_coefficients(u);
  const auto slope = small_angle::inverse_jacobian_coefficient_slopes(u, c);
  const Scalar du = Scalar(2) * phi.dot(rho);
  return {hat_plus_symmetric<Scalar>(c.half_cot, phi / Scalar(-2), phi, (c.d / Scalar(2)) * phi),
          hat_plus_symmetric<Scalar>(du * slope.half_cot, rho / Scalar(-2), phi,
                                     c.d * rho + (du * slope.d / Scalar(2)) * phi)};
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::adjoint() const {
  return adjoint_blocks().dense();
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::adjoint_congruence(const TangentMatrix& p) const {
  return adjoint_blocks().congruence(p);
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::ad(const Tangent& xi) {
  return Blocks{Rotation::hat(xi.template head<3>()), Rotation::hat(xi.template tail<3>())}.dense();
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::left_jacobian(const Tangent& xi) {
  return left_jacobian_blocks(xi).dense();
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::left_jacobian_inverse(const Tangent& xi) {
  return left_jacobian_inverse_blocks(xi).dense();
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::left_jacobian_congruence(const Tangent& xi,
                                                                const TangentMatrix& p) {
  return left_jacobian_blocks(xi).congruence(p);
}

template <typename S>
typename SE3<S>::TangentMatrix SE3<S>::left_jacobian_inverse_congruence(const Tangent& xi,
                                                                        const TangentMatrix& p) {
  return left_jacobian_inverse_blocks(xi).congruence(p);
}

template <typename S>
bool SE3<S>::is_approx(const SE3& other, const Scalar& tol) const {
  return rotation_.is_approx(other.rotation_, tol) &&
         (translation_ - other.translation_).norm() <= tol;
}

extern template class SE3<double>;

}  // namespace posemix
