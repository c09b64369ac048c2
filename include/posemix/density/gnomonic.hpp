// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "posemix/lie/lie.hpp"

/// The gnomonic chart of rotations: the tangent space of the unit quaternions at q0, projected to
/// the sphere through its centre (MPG paper, eq. 8). For the rotation by theta about `axis`, in the
/// frame that q0 rotates, u = axis tan(theta/2); rotations by pi relative to q0 have no u. The
/// measure of the half sphere of quaternions is dm = (1 + u.u)^-2 du; the Haar measure, in rad^3 of
/// the rotation vector at the identity, is 8 dm.
namespace posemix::gnomonic {

/// log 8: the ratio of the Haar measure to the measure of the half sphere of quaternions is 8.
inline constexpr double kLogHaarPerHalfSphere = 2.0794415416798359282516963643745;

/// The rotation q0 (1, u) / sqrt(1 + u.u).
inline SO3d project(const SO3d& tangent_point, const Eigen::Vector3d& u) {
  return tangent_point * SO3d::from_quaternion(Eigen::Quaterniond(1.0, u.x(), u.y(), u.z()));
}

/// The coordinates u of a rotation, equal for q and -q; infinite or NaN if the rotation has no u.
inline Eigen::Vector3d lift(const SO3d& tangent_point, const SO3d& rotation) {
  const Eigen::Quaterniond r = tangent_point.quaternion().conjugate() * rotation.quaternion();
  return r.vec() / r.w();
}

/// The rotation halfway between two rotations: the normalised sum of their quaternions, with the
/// signs for which these are nearest to each other.
inline SO3d halfway(const SO3d& a, const SO3d& b) {
  const double sign = a.quaternion().dot(b.quaternion()) < 0.0 ? -1.0 : 1.0;
  return SO3d::from_quaternion(Eigen::Quaterniond(
      Eigen::Vector4d(a.quaternion().coeffs() + sign * b.quaternion().coeffs())));
}

/// The change of coordinates from the chart at `from` to the chart at `to`, u -> f(u), with its
/// derivatives (MPG paper, eq. 15). With r = to^-1 from = (r0, rv):
///   f = (rv + r0 u + rv x u) / (r0 - rv.u).
class ChartChange {
 public:
  ChartChange(const SO3d& from, const SO3d& to)
      : r_(to.quaternion().conjugate() * from.quaternion()) {}

  Eigen::Vector3d operator()(const Eigen::Vector3d& u) const {
    return (r_.vec() + r_.w() * u + r_.vec().cross(u)) / denominator(u);
  }
  /// df/du = (r0 I + [rv]x + f rv^T) / (r0 - rv.u).
  Eigen::Matrix3d jacobian(const Eigen::Vector3d& u) const {
    Eigen::Matrix3d j = SO3d::hat(r_.vec()) + (*this)(u)*r_.vec().transpose();
    j.diagonal().array() += r_.w();
    return j / denominator(u);
  }
  /// log det df/du, where det df/du = ((1 + f.f) / (1 + u.u))^2.
  double log_det_jacobian(const Eigen::Vector3d& u) const {
    return 2.0 * (std::log1p((*this)(u).squaredNorm()) - std::log1p(u.squaredNorm()));
  }
  /// sum_k g_k d^2 f_k / du^2 = (b c^T + c b^T) for b = J^T g, c = rv / (r0 - rv.u).
  Eigen::Matrix3d second_derivative(const Eigen::Vector3d& u, const Eigen::Vector3d& g) const {
    const Eigen::Vector3d b = jacobian(u).transpose() * g;
    const Eigen::Vector3d c = r_.vec() / denominator(u);
    return b * c.transpose() + c * b.transpose();
  }
  /// The sign is the side of the equator of `to` on which the rotation lies.
  double denominator(const Eigen::Vector3d& u) const { return r_.w() - r_.vec().dot(u); }

 private:
  Eigen::Quaterniond r_;
};

}  // namespace posemix::gnomonic
