// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include <boost/math/constants/constants.hpp>

#include <Eigen/Core>

#include "oracle.hpp"

/// The tangent vectors at which accuracy is measured.
namespace posemix::oracle {

/// Angles (rad) in [0, pi], dense at every branch of the implementation: tiny values whose squares
/// underflow (series constants, the small branch of Log at sin = 1e-146), the end of the Taylor
/// series at 2 rad, pi and its neighbours.
template <typename Scalar>
std::vector<Scalar> angles_to_pi() {
  using std::nextafter;
  std::vector<Scalar> angles{Scalar(0)};
  for (const double a :
       {1e-300, 1e-200, 1e-162, 1e-160, 1e-154, 1e-147, 2e-146, 4e-146, 1e-145, 1e-100,
        1e-40,  1e-30,  1e-20,  1e-19,  1e-18,  1e-16,  1e-15,  1e-12,  1e-10,  1e-8,
        1e-7,   1e-5,   1e-4,   1e-3,   0.01,   0.1,    0.3,    0.5,    0.7,    1.0,
        1.3,    1.5,    1.57,   1.8,    1.9,    2.1,    2.5,    2.9,    3.0,    3.1}) {
    angles.push_back(Scalar(a));
  }
  const Scalar eps = std::numeric_limits<Scalar>::epsilon();
  for (const int k : {-64, -8, -4, -2, -1, 0, 1, 2, 4, 8, 64}) {
    angles.push_back(Scalar(2) + Scalar(k) * eps);
  }
  const Scalar pi = static_cast<Scalar>(boost::math::constants::pi<Real>());
  angles.push_back(pi);
  for (const double below : {1e-15, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3})
    angles.push_back(pi - Scalar(below));
  return angles;
}

/// Angles (rad) beyond pi, up to 3/2 pi, with the branch of log |det J_l| near 3.79 rad and that of
/// Exp at 4 rad.
template <typename Scalar>
std::vector<Scalar> angles_beyond_pi() {
  const Scalar eps = std::numeric_limits<Scalar>::epsilon();
  std::vector<Scalar> angles;
  for (const double a :
       {3.1415926546, 3.142, 3.2, 3.5, 3.78, 3.79, 3.7909, 3.791, 3.8, 3.999, 4.001, 4.3, 4.712}) {
    angles.push_back(Scalar(a));
  }
  for (const int k : {-8, -2, 0, 2, 8}) angles.push_back(Scalar(4) + Scalar(k) * eps);
  return angles;
}

template <typename Scalar>
std::vector<Eigen::Matrix<Scalar, 3, 1>> directions() {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  std::vector<Vector3> axes{Vector3::UnitX(), -Vector3::UnitZ()};
  for (const auto& [x, y, z] :
       {std::array{1, 1, 1}, std::array{-3, 4, 12}, std::array{1000, -1, 7}}) {
    axes.push_back(Vector3(Scalar(x), Scalar(y), Scalar(z)).normalized());
  }
  return axes;
}

/// Rotation vectors; those of angle pi may exceed it by rounding, like any input.
template <typename Scalar>
std::vector<Eigen::Matrix<Scalar, 3, 1>> rotation_vectors(const std::vector<Scalar>& angles) {
  std::vector<Eigen::Matrix<Scalar, 3, 1>> vectors;
  for (const Scalar& angle : angles) {
    for (const auto& axis : directions<Scalar>()) vectors.push_back(angle * axis);
  }
  return vectors;
}

/// Translations (m) along, across and askew to `axis`, tiny to large.
template <typename Scalar>
std::vector<Eigen::Matrix<Scalar, 3, 1>> translations(const Eigen::Matrix<Scalar, 3, 1>& axis) {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  const Vector3 skew(Scalar(0.3), Scalar(-1.7), Scalar(0.9));
  return {axis * Scalar(2), axis.cross(skew), skew, skew * Scalar(1e-12), skew * Scalar(1e8)};
}

/// Twists with every angle, direction and translation; two directions suffice for scalars other
/// than double.
template <typename Scalar>
std::vector<Eigen::Matrix<Scalar, 6, 1>> twists(const std::vector<Scalar>& angles) {
  auto axes = directions<Scalar>();
  if (!std::is_same_v<Scalar, double>) axes.erase(axes.begin() + 1, axes.end() - 1);
  std::vector<Eigen::Matrix<Scalar, 6, 1>> result;
  for (const Scalar& angle : angles) {
    for (const auto& axis : axes) {
      for (const auto& rho : translations<Scalar>(axis)) {
        result.emplace_back();
        result.back() << angle * axis, rho;
      }
    }
  }
  return result;
}

}  // namespace posemix::oracle
