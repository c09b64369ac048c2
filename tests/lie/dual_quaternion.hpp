// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include <fmt/format.h>

#include "posemix/lie/se3.hpp"

namespace posemix {

/// A unit dual quaternion q_r + eps q_d, eps^2 = 0: a rigid motion with rotation q_r and
/// q_d = q_t q_r / 2, q_t the imaginary quaternion of the translation in metres (MPG paper, III-A,
/// eq. 2-4).
///
/// Invariants:
/// - |q_r| = 1 and <q_r, q_d> = 0, to a few units in the last place;
/// - the product is the composition of the motions; x and -x are the same motion (double cover).
///
/// Quaternions are Eigen's, products by Hamilton's rule.
template <typename S>
class DualQuaternion {
 public:
  using Scalar = S;
  using Quaternion = Eigen::Quaternion<Scalar>;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

  /// The identity.
  DualQuaternion() : real_(Quaternion::Identity()), dual_(zero()) {}

  explicit DualQuaternion(const SE3<Scalar>& pose)
      : real_(pose.rotation().quaternion()),
        dual_(scaled(Scalar(0.5), imaginary(pose.translation()) * real_)) {}  // eq. 4

  /// The dual quaternion with these parts.
  /// @throws InvalidInput where |real| differs from one, or <real, dual> from zero, by more than
  /// `tol`, or an entry is not finite
  static DualQuaternion from_parts(const Quaternion& real, const Quaternion& dual,
                                   const Scalar& tol = Scalar(1e-6)) {
    using std::abs;
    const Scalar norm = real.norm();
    const Scalar inner = real.dot(dual);
    if (!(abs(norm - Scalar(1)) <= tol) || !(abs(inner) <= tol) || !dual.coeffs().allFinite()) {
      throw InvalidInput(
          fmt::format("dual quaternion with |real| = {} and <real, dual> = {}, expected 1 and 0",
                      static_cast<double>(norm), static_cast<double>(inner)));
    }
    DualQuaternion result;
    result.real_ = real;
    result.dual_ = dual;
    return result.normalized();
  }

  const Quaternion& real() const { return real_; }
  const Quaternion& dual() const { return dual_; }

  /// The motion: rotation q_r, translation 2 q_d q_r*.
  SE3<Scalar> pose() const {
    return SE3<Scalar>(SO3<Scalar>::from_quaternion(real_), translation());
  }
  Vector3 translation() const { return Scalar(2) * (dual_ * real_.conjugate()).vec(); }

  DualQuaternion operator*(const DualQuaternion& other) const {
    DualQuaternion result;
    result.real_ = real_ * other.real_;
    result.dual_ = sum(real_ * other.dual_, dual_ * other.real_);
    return result.normalized();
  }

  DualQuaternion operator-() const {
    return of(scaled(Scalar(-1), real_), scaled(Scalar(-1), dual_));
  }

  /// q_r* + eps q_d*, the inverse motion.
  DualQuaternion quaternion_conjugate() const { return of(real_.conjugate(), dual_.conjugate()); }
  /// q_r - eps q_d: the same rotation, the opposite translation.
  DualQuaternion dual_conjugate() const { return of(real_, scaled(Scalar(-1), dual_)); }
  /// q_r* - eps q_d*, which transforms points: see operator*.
  DualQuaternion total_conjugate() const {
    return of(real_.conjugate(), scaled(Scalar(-1), dual_.conjugate()));
  }

  /// The point moved: the dual part of x (1 + eps p) x', where x' must be the total conjugate.
  /// (With the quaternion conjugate, as eq. 5 has it, the translation cancels.)
  Vector3 operator*(const Vector3& point) const {
    const Quaternion moved = real_ * imaginary(point) * real_.conjugate();
    return moved.vec() + translation();
  }

  /// Whether both are the same motion, up to `tol` in every entry of the parts, whatever their
  /// signs.
  bool is_approx(const DualQuaternion& other, const Scalar& tol) const {
    const Scalar sign = real_.dot(other.real_) < Scalar(0) ? Scalar(-1) : Scalar(1);
    const auto apart = [&](const Quaternion& a, const Quaternion& b) {
      return (a.coeffs() - sign * b.coeffs()).cwiseAbs().maxCoeff();
    };
    return apart(real_, other.real_) <= tol && apart(dual_, other.dual_) <= tol;
  }

 private:
  static Quaternion zero() { return Quaternion(Scalar(0), Scalar(0), Scalar(0), Scalar(0)); }
  static Quaternion imaginary(const Vector3& v) {
    return Quaternion(Scalar(0), v.x(), v.y(), v.z());
  }
  static Quaternion scaled(const Scalar& factor, const Quaternion& q) {
    return Quaternion(typename Quaternion::Coefficients(factor * q.coeffs()));
  }
  static Quaternion sum(const Quaternion& a, const Quaternion& b) {
    return Quaternion(typename Quaternion::Coefficients(a.coeffs() + b.coeffs()));
  }
  static DualQuaternion of(const Quaternion& real, const Quaternion& dual) {
    DualQuaternion result;
    result.real_ = real;
    result.dual_ = dual;
    return result;
  }

  /// Divided by its dual norm |q_r| + eps <q_r, q_d> / |q_r|.
  DualQuaternion normalized() const {
    const Scalar norm = real_.norm();
    const Quaternion real = scaled(Scalar(1) / norm, real_);
    const Quaternion dual = scaled(Scalar(1) / norm, dual_);
    return of(real, sum(dual, scaled(-real.dot(dual), real)));
  }

  Quaternion real_;
  Quaternion dual_;
};

using DualQuaterniond = DualQuaternion<double>;

}  // namespace posemix
