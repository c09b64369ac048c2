// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include <Eigen/Dense>

/// SE(3) by textbook formulas (Barfoot 2017, chapter 7) in plain Eigen, rotation first: what anyone
/// writes down, for any scalar. Nothing of the library is used.
namespace dense {

template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using Matrix6 = Eigen::Matrix<S, 6, 6>;
template <class S>
using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class S>
struct Pose {
  Matrix3<S> r;
  Vector3<S> t;

  Pose operator*(const Pose& other) const { return {r * other.r, r * other.t + t}; }
  Pose inverse() const {
    const Matrix3<S> back = r.transpose();
    return {back, -(back * t)};
  }
};

template <class S>
Matrix3<S> hat(const Vector3<S>& v) {
  const S zero(0);
  Matrix3<S> m;
  m << zero, -v(2), v(1), v(2), zero, -v(0), -v(1), v(0), zero;
  return m;
}

template <class S>
Matrix6<S> adjoint(const Pose<S>& x) {
  Matrix6<S> m = Matrix6<S>::Zero();
  m.template topLeftCorner<3, 3>() = m.template bottomRightCorner<3, 3>() = x.r;
  m.template bottomLeftCorner<3, 3>() = hat(x.t) * x.r;
  return m;
}

/// Whether an angle is so small that two terms of a series are better than differences. With many
/// digits they never are.
template <class S>
bool is_small(const S& square, double below) {
  if constexpr (std::is_same_v<S, double>) return square < below;
  return false;
}

/// sin(a)/a, (1 - cos a)/a^2, (a - sin a)/a^3 for an angle a.
template <class S>
struct Coefficients {
  S a, b, c;

  explicit Coefficients(const S& square) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const S angle = sqrt(square);
    const bool small = is_small(square, 1e-4);
    a = small ? S(1 - square / 6 * (1 - square / 20)) : S(sin(angle) / angle);
    b = small ? S((1 - square / 12 * (1 - square / 30)) / 2) : S((1 - cos(angle)) / square);
    c = small ? S((1 - square / 20 * (1 - square / 42)) / 6) : S((1 - a) / square);
  }
};

template <class S>
Matrix3<S> exp_rotation(const Vector3<S>& phi) {
  const Matrix3<S> w = hat(phi);
  const Coefficients<S> k(phi.squaredNorm());
  return Matrix3<S>::Identity() + k.a * w + k.b * (w * w);
}

template <class S>
Pose<S> exp(const Vector6<S>& xi) {
  const Matrix3<S> w = hat<S>(xi.template head<3>());
  const Matrix3<S> w2 = w * w;
  const Coefficients<S> k(xi.template head<3>().squaredNorm());
  const Matrix3<S> v = Matrix3<S>::Identity() + k.b * w + k.c * w2;
  return {Matrix3<S>::Identity() + k.a * w + k.b * w2, v * xi.template tail<3>()};
}

/// The factor g of J_l^-1 = I - W/2 + g W^2 on SO(3).
template <class S>
S inverse_factor(const S& square) {
  if (is_small(square, 1e-4)) return (1 + square / 60) / 12;
  const Coefficients<S> k(square);
  return (1 - k.a / (2 * k.b)) / square;
}

template <class S>
Vector3<S> log_rotation(const Matrix3<S>& r) {
  using std::atan2;
  Vector3<S> axis(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  axis /= S(2);
  const S sine = axis.norm();
  if (is_small(sine, 1e-9)) return axis;
  return S(atan2(sine, S((r.trace() - 1) / 2)) / sine) * axis;
}

template <class S>
Vector6<S> log(const Pose<S>& x) {
  const Vector3<S> phi = log_rotation(x.r);
  const Vector3<S> turned = phi.cross(x.t);
  Vector6<S> xi;
  xi.template head<3>() = phi;
  xi.template tail<3>() =
      x.t - turned / S(2) + inverse_factor(phi.squaredNorm()) * phi.cross(turned);
  return xi;
}

/// The matrix Q of J_l (Barfoot, eq. 7.86).
template <class S>
Matrix3<S> q_block(const Vector6<S>& xi) {
  const S square = xi.template head<3>().squaredNorm();
  const Matrix3<S> p = hat<S>(xi.template head<3>());
  const Matrix3<S> r = hat<S>(xi.template tail<3>());
  const Coefficients<S> k(square);
  const S cosine = 1 - square * k.b;
  const S square2 = square * square;
  const bool small = is_small(square, 1e-2);
  const S c = small ? S((1 - square / 30 * (1 - square / 56)) / 24)
                    : S((square / 2 - 1 + cosine) / square2);
  const S d = small ? S((1 - square / 21 * (1 - square / 48)) / 120)
                    : S((2 - 3 * k.a + cosine) / (2 * square2));
  const Matrix3<S> pr = p * r;
  const Matrix3<S> rp = r * p;
  const Matrix3<S> prp = pr * p;
  return r / S(2) + k.c * (pr + rp + prp) + c * (p * pr + rp * p - S(3) * prp) +
         d * (prp * p + p * prp);
}

template <class S>
Matrix6<S> left_jacobian_inverse(const Vector6<S>& xi) {
  const Matrix3<S> p = hat<S>(xi.template head<3>());
  const S g = inverse_factor<S>(xi.template head<3>().squaredNorm());
  const Matrix3<S> inverse = Matrix3<S>::Identity() - p / S(2) + g * (p * p);
  Matrix6<S> m = Matrix6<S>::Zero();
  m.template topLeftCorner<3, 3>() = m.template bottomRightCorner<3, 3>() = inverse;
  m.template bottomLeftCorner<3, 3>() = -inverse * q_block(xi) * inverse;
  return m;
}

/// The Jacobian to [phi; rho] of errors of x, y, z, yaw, pitch and roll, in which MRPT states
/// covariances.
inline Matrix6<double> angles_to_tangent(const Pose<double>& x) {
  const double yaw = std::atan2(x.r(1, 0), x.r(0, 0));
  const double pitch = std::asin(-x.r(2, 0));
  Matrix3<double> e;
  e.col(0) << 0, 0, 1;
  e.col(1) << -std::sin(yaw), std::cos(yaw), 0;
  e.col(2) << std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), -std::sin(pitch);
  Matrix6<double> m = Matrix6<double>::Zero();
  m.topRightCorner<3, 3>() = e;
  m.bottomLeftCorner<3, 3>().setIdentity();
  m.bottomRightCorner<3, 3>() = hat(x.t) * e;
  return m;
}

/// Vectors of six, one after another.
template <class S>
std::vector<Vector6<S>> vectors_of(const std::vector<double>& numbers) {
  std::vector<Vector6<S>> result;
  for (std::size_t i = 0; i < numbers.size(); i += 6) {
    result.push_back(Eigen::Map<const Vector6<double>>(&numbers[i]).cast<S>());
  }
  return result;
}

/// Square matrices, each row by row.
template <class S, int kSize = 6>
std::vector<Eigen::Matrix<S, kSize, kSize>> matrices_of(const std::vector<double>& numbers) {
  std::vector<Eigen::Matrix<S, kSize, kSize>> result;
  for (std::size_t i = 0; i < numbers.size(); i += kSize * kSize) {
    result.push_back(
        Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(&numbers[i])
            .template cast<S>());
  }
  return result;
}

/// Poses of 4x4 matrices, row by row.
template <class S>
std::vector<Pose<S>> poses_of(const std::vector<double>& numbers) {
  std::vector<Pose<S>> result;
  for (const auto& m : matrices_of<S, 4>(numbers)) {
    result.push_back({m.template topLeftCorner<3, 3>(), m.template topRightCorner<3, 1>()});
  }
  return result;
}

/// Adds the numbers of a matrix, row by row.
template <class Derived>
void append(std::vector<double>& numbers, const Eigen::MatrixBase<Derived>& m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) numbers.push_back(static_cast<double>(m(i, j)));
  }
}

template <class S>
void append(std::vector<double>& numbers, const Pose<S>& x) {
  Eigen::Matrix<S, 4, 4> m = Eigen::Matrix<S, 4, 4>::Identity();
  m.template topLeftCorner<3, 3>() = x.r;
  m.template topRightCorner<3, 1>() = x.t;
  append(numbers, m);
}

template <class Out>
std::vector<double> flat(const std::vector<Out>& values) {
  std::vector<double> numbers;
  for (const Out& value : values) append(numbers, value);
  return numbers;
}

}  // namespace dense
