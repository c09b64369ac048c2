// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "posemix/base/error.hpp"
#include "posemix/lie/small_angle.hpp"
#include "posemix/lie/twist_matrix.hpp"

namespace posemix {

template <typename S>
class SE3;

/// Rotations of three-space. Tangent: rotation vector phi in radians.
///
/// Invariants:
/// - the stored quaternion has unit norm to a few units in the last place, because every product
///   renormalises;
/// - q and -q are the same rotation: every function gives the same result for both;
/// - log() has norm at most pi; at exactly pi its first non-zero component is positive.
///
/// The closed forms are those of Barfoot, State Estimation for Robotics, section 7.1.
template <typename S>
class SO3 {
 public:
  using Scalar = S;
  static constexpr int Dof = 3;
  using Tangent = Eigen::Matrix<Scalar, 3, 1>;
  using TangentMatrix = Eigen::Matrix<Scalar, 3, 3>;
  using Matrix = Eigen::Matrix<Scalar, 3, 3>;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  using Quaternion = Eigen::Quaternion<Scalar>;

  /// The identity.
  SO3() : q_(Scalar(1), Scalar(0), Scalar(0), Scalar(0)) {}

  /// The rotation of `q` / |q|.
  /// @throws InvalidInput when |q| is zero or not finite
  static SO3 from_quaternion(const Quaternion& q);

  /// The rotation of a quaternion that was written from another rotation: if |q|^2 is one within 16
  /// units in the last place, `q` is kept bit by bit, otherwise it is normalised as by
  /// from_quaternion.
  static SO3 from_stored_quaternion(const Quaternion& q);

  /// The rotation nearest to the 3x3 matrix `r`.
  /// @throws InvalidInput when an entry of r^T r - I exceeds `tol` in absolute value, det r < 0, or
  /// an entry is not finite
  static SO3 from_matrix(const Matrix& r, const Scalar& tol = Scalar(1e-6));

  /// The rotation by the angle |phi| [rad] about phi.
  static SO3 exp(const Tangent& phi);

  /// The rotation vector [rad], of norm at most pi.
  Tangent log() const;

  const Quaternion& quaternion() const { return q_; }
  Matrix matrix() const { return q_.toRotationMatrix(); }

  /// The angle of rotation in [0, pi] [rad].
  Scalar angle() const;

  SO3 operator*(const SO3& other) const { return SO3(renormalised(q_ * other.q_)); }

  /// The rotated point `p`.
  Vector3 operator*(const Vector3& p) const { return q_ * p; }

  SO3 inverse() const { return SO3(q_.conjugate()); }
  static SO3 identity() { return SO3(); }
  static Eigen::Index dof() { return Dof; }

  TangentMatrix adjoint() const { return matrix(); }

  /// Ad P Ad^T for a symmetric P.
  TangentMatrix adjoint_congruence(const TangentMatrix& p) const;

  /// The skew-symmetric matrix phi^ with phi^ p = phi x p.
  static Matrix hat(const Tangent& phi);

  /// The inverse of hat, applied to the skew-symmetric part of `m`.
  static Tangent vee(const Matrix& m);

  static TangentMatrix ad(const Tangent& phi) { return hat(phi); }

  static TangentMatrix left_jacobian(const Tangent& phi);

  /// J_l^-1(phi), singular at |phi| = 2 pi, 4 pi, ...
  static TangentMatrix left_jacobian_inverse(const Tangent& phi);

  static TangentMatrix right_jacobian(const Tangent& phi) { return left_jacobian(-phi); }
  static TangentMatrix right_jacobian_inverse(const Tangent& phi) {
    return left_jacobian_inverse(-phi);
  }

  /// log |det J_l| = log(2 (1 - cos theta) / theta^2).
  static Scalar log_abs_det_left_jacobian(const Tangent& phi) {
    return Scalar(2) * small_angle::log_abs_sinc(Scalar(phi.squaredNorm() / Scalar(4)));
  }

  /// J_l P J_l^T for a symmetric P.
  static TangentMatrix left_jacobian_congruence(const Tangent& phi, const TangentMatrix& p);

  /// J_l^-1 P J_l^-T for a symmetric P.
  static TangentMatrix left_jacobian_inverse_congruence(const Tangent& phi, const TangentMatrix& p);

  /// Whether the angle between the two rotations is at most `tol` [rad].
  bool is_approx(const SO3& other, const Scalar& tol) const;

  template <typename Other>
  SO3<Other> cast() const {
    return SO3<Other>::from_quaternion(q_.template cast<Other>());
  }

 private:
  template <typename>
  friend class SE3;

  /// The quaternion with w >= 0 and the coefficients of Log; h = theta/2 is half of the angle.
  struct HalfAngle {
    Vector3 v;
    Scalar w;
    Scalar ratio;  ///< h / |v|: Log = 2 ratio v
    Scalar outer;  ///< (1 - h cot h) / |v|^2, or zero if |v|^2 underflows
  };
  HalfAngle half_angle() const;
  /// Exp(phi) from cos(h) and sin(h)/h.
  static SO3 of_half_angle(const small_angle::CosineAndSinc<Scalar>& half, const Tangent& phi);

  explicit SO3(const Quaternion& unit) : q_(unit) {}

  /// One Newton step towards |q| = 1.
  static Quaternion renormalised(const Quaternion& q) {
    const Scalar scale = (Scalar(3) - q.squaredNorm()) / Scalar(2);
    return Quaternion(q.w() * scale, q.x() * scale, q.y() * scale, q.z() * scale);
  }

  static TangentMatrix congruence(const TangentMatrix& j, const TangentMatrix& p);

  Quaternion q_;
};

template <typename S>
SO3<S> SO3<S>::from_quaternion(const Quaternion& q) {
  if (!q.coeffs().allFinite()) throw InvalidInput("quaternion has a component that is not finite");
  const Scalar largest = q.coeffs().cwiseAbs().maxCoeff();
  if (!(largest > Scalar(0)))
    throw InvalidInput("quaternion has zero norm; expected a non-zero one");
  Quaternion scaled(q.w() / largest, q.x() / largest, q.y() / largest, q.z() / largest);
  scaled.coeffs() /= scaled.norm();
  return SO3(renormalised(scaled));
}

template <typename S>
SO3<S> SO3<S>::from_stored_quaternion(const Quaternion& q) {
  using std::abs;
  const Scalar defect = abs(q.squaredNorm() - Scalar(1));
  const bool unit = defect <= Scalar(16) * std::numeric_limits<Scalar>::epsilon();
  return unit ? SO3(q) : from_quaternion(q);
}

template <typename S>
SO3<S> SO3<S>::from_matrix(const Matrix& r, const Scalar& tol) {
  if (!r.allFinite()) throw InvalidInput("rotation matrix has an entry that is not finite");
  Matrix rotation = r;
  Matrix defect = r.transpose() * r - Matrix::Identity();
  const Scalar deviation = defect.cwiseAbs().maxCoeff();
  if (!(deviation <= tol)) {
    throw InvalidInput(
        fmt::format("rotation matrix is not orthonormal: an entry of R^T R - I is {:.6g}; expected "
                    "at most {:.6g}",
                    static_cast<double>(deviation), static_cast<double>(tol)));
  }
  if (r.determinant() <= Scalar(0)) {
    throw InvalidInput(r.determinant() < Scalar(0)
                           ? "rotation matrix has determinant -1 (a reflection); expected +1"
                           : "rotation matrix has determinant 0; expected +1");
  }
  const Scalar rounding = Scalar(8) * std::numeric_limits<Scalar>::epsilon();
  constexpr int kMaxPolarSteps = 200;
  // Newton steps to the nearest rotation from afar, and Newton-Schulz steps, which need no inverse.
  for (int step = 0; step < kMaxPolarSteps && defect.cwiseAbs().maxCoeff() > rounding; ++step) {
    if (defect.cwiseAbs().maxCoeff() > Scalar(0.5)) {
      rotation = ((rotation + rotation.inverse().transpose()) / Scalar(2)).eval();
    } else {
      rotation -= (rotation * defect / Scalar(2)).eval();
    }
    defect = rotation.transpose() * rotation - Matrix::Identity();
  }
  return from_quaternion(Quaternion(rotation));
}

template <typename S>
SO3<S> SO3<S>::exp(const Tangent& phi) {
  return of_half_angle(small_angle::cosine_and_sinc(Scalar(phi.squaredNorm() / Scalar(4))), phi);
}

template <typename S>
SO3<S> SO3<S>::of_half_angle(const small_angle::CosineAndSinc<Scalar>& half, const Tangent& phi) {
  const Scalar scale = half.sinc / Scalar(2);
  return SO3(
      renormalised(Quaternion(half.cosine, scale * phi.x(), scale * phi.y(), scale * phi.z())));
}

template <typename S>
typename SO3<S>::Tangent SO3<S>::log() const {
  const HalfAngle half = half_angle();
  return (Scalar(2) * half.ratio) * half.v;
}

template <typename S>
typename SO3<S>::HalfAngle SO3<S>::half_angle() const {
  using std::atan2;
  using std::sqrt;
  HalfAngle half{q_.vec(), q_.w(), Scalar(0), Scalar(0)};
  const Tangent& v = half.v;
  const Scalar zero(0);
  const bool negative_axis =
      v.x() < zero || (v.x() == zero && (v.y() < zero || (v.y() == zero && v.z() < zero)));
  if (half.w < zero || (half.w == zero && negative_axis)) {
    half.v = -half.v;
    half.w = -half.w;
  }
  const Scalar n2 = v.squaredNorm();
  const Scalar underflow =
      std::numeric_limits<Scalar>::min() / std::numeric_limits<Scalar>::epsilon();
  if (n2 < underflow) {
    half.ratio = Scalar(1) / half.w;
  } else {
    const Scalar n = sqrt(n2);
    half.ratio = atan2(n, half.w) / n;
    half.outer = (Scalar(1) - half.ratio * half.w) / n2;
  }
  return half;
}

template <typename S>
S SO3<S>::angle() const {
  using std::abs;
  using std::atan2;
  return Scalar(2) * atan2(Scalar(q_.vec().norm()), Scalar(abs(q_.w())));
}

template <typename S>
typename SO3<S>::Matrix SO3<S>::hat(const Tangent& phi) {
  Matrix m;
  m << Scalar(0), -phi.z(), phi.y(),  //
      phi.z(), Scalar(0), -phi.x(),   //
      -phi.y(), phi.x(), Scalar(0);
  return m;
}

template <typename S>
typename SO3<S>::Tangent SO3<S>::vee(const Matrix& m) {
  return Tangent(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)) / Scalar(2);
}

template <typename S>
typename SO3<S>::TangentMatrix SO3<S>::left_jacobian(const Tangent& phi) {
  const auto c = small_angle::jacobian_coefficients(Scalar(phi.squaredNorm()));
  return hat_plus_symmetric<Scalar>(c.a, c.b * phi, phi, (c.c / Scalar(2)) * phi);
}

template <typename S>
typename SO3<S>::TangentMatrix SO3<S>::left_jacobian_inverse(const Tangent& phi) {
  const auto c = small_angle::inverse_jacobian_coefficients(Scalar(phi.squaredNorm()));
  return hat_plus_symmetric<Scalar>(c.half_cot, phi / Scalar(-2), phi, (c.d / Scalar(2)) * phi);
}

template <typename S>
typename SO3<S>::TangentMatrix SO3<S>::congruence(const TangentMatrix& j, const TangentMatrix& p) {
  const TangentMatrix jp = j * p;
  return mirror_upper(jp * j.transpose());
}

template <typename S>
typename SO3<S>::TangentMatrix SO3<S>::adjoint_congruence(const TangentMatrix& p) const {
  return congruence(matrix(), p);
}

template <typename S>
typename SO3<S>::TangentMatrix SO3<S>::left_jacobian_congruence(const Tangent& phi,
                                                                const TangentMatrix& p) {
  return congruence(left_jacobian(phi), p);
}

template <typename S>
typename SO3<S>::TangentMatrix SO3<S>::left_jacobian_inverse_congruence(const Tangent& phi,
                                                                        const TangentMatrix& p) {
  return congruence(left_jacobian_inverse(phi), p);
}

template <typename S>
bool SO3<S>::is_approx(const SO3& other, const Scalar& tol) const {
  return (inverse() * other).angle() <= tol;
}

extern template class SO3<double>;

}  // namespace posemix
