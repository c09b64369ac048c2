// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include "posemix/lie/lie.hpp"

/// Numbers, poses and covariances out of bytes, for targets that are no readers of files.
namespace posemix::fuzzing {

/// Takes values from the front of the bytes; all are zero at the end. Few bytes make a value, so
/// that a change of one of them is a change of one value.
class Input {
 public:
  explicit Input(std::string_view bytes) : rest_(bytes) {}

  bool empty() const { return rest_.empty(); }

  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const auto value = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return value;
  }

  /// Zero to `bound` - 1.
  std::size_t below(std::size_t bound) { return byte() % bound; }
  bool flag() { return byte() % 2 == 1; }

  /// Mostly a number in [-1, 1]; one time in sixteen one that is awkward or hostile.
  double number() {
    const std::uint8_t kind = byte();
    if (kind < 240) return (static_cast<int>(kind) - 120) / 120.0 + byte() / 30720.0 - 1.0 / 240.0;
    static constexpr std::array<double, 16> kAwkward{
        0.0,    -0.0,
        1e-300, -1e-12,
        1e-6,   3.141592653589793,
        -3.2,   100.0,
        1e3,    -1e4,
        1e6,    1e9,
        1e155,  -1e300,
        kInf,   std::numeric_limits<double>::quiet_NaN()};
    return kAwkward[kind - 240U];
  }
  /// A positive number between 2^-16 and 2^15.9 times `unit`, or one that is hostile.
  double scale(double unit) {
    const std::uint8_t kind = byte();
    if (kind < 252) return unit * std::exp2((static_cast<int>(kind) - 126) / 16.0);
    static constexpr std::array<double, 4> kHostile{0.0, -1.0, kInf,
                                                    std::numeric_limits<double>::quiet_NaN()};
    return kHostile[kind - 252U];
  }

  Vector6d tangent(double rotation, double translation) {
    Vector6d xi;
    for (double& x : xi) x = number();
    xi.head<3>() *= rotation;
    xi.tail<3>() *= translation;
    return xi;
  }
  /// Rotations of up to some 5 rad; a pose that is not finite where a number is not.
  SE3d pose(double translation = 1.0) {
    const Vector6d xi = tangent(3.2, translation);
    return SE3d(SO3d::exp(xi.head<3>()), xi.tail<3>());
  }
  /// Mostly symmetric positive definite.
  Matrix6d covariance(double rotation_sd, double translation_sd) {
    const std::uint8_t kind = byte();
    Vector6d sds = Vector6d::Constant(rotation_sd);
    sds.tail<3>().setConstant(translation_sd);
    if (kind < 128) {
      sds.head<3>() *= scale(1.0);
      sds.tail<3>() *= scale(1.0);
      return Matrix6d(sds.cwiseAbs2().asDiagonal());
    }
    Matrix6d root = Matrix6d::Identity();
    for (int k = 0; k < 4; ++k)
      root(static_cast<Eigen::Index>(below(6)), static_cast<Eigen::Index>(below(6))) += number();
    root = sds.asDiagonal() * root;
    Matrix6d result = root * root.transpose();
    if (kind >= 250) result(0, 5) += number();
    return result;
  }

 private:
  static constexpr double kInf = std::numeric_limits<double>::infinity();

  std::string_view rest_;
};

}  // namespace posemix::fuzzing
