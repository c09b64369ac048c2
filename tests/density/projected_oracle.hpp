// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/density/projected_gaussian.hpp"

namespace posemix::oracle {

/// A_ij = ((7 i + 3 j + 5 seed) mod 11 - 5) / 10, and D (A A^T + I) D: the covariances of the
/// oracles, with rotation and translation spreads on the diagonal of D.
inline Matrix6d covariance(int seed, double rotation, double translation) {
  Matrix6d a;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) a(i, j) = ((7 * i + 3 * j + 5 * seed) % 11 - 5) / 10.0;
  }
  Vector6d d;
  d << rotation, rotation, rotation, translation, translation, translation;
  return d.asDiagonal() * (a * a.transpose() + Matrix6d::Identity()) * d.asDiagonal();
}

inline Matrix6d first_covariance() { return covariance(1, 0.1, 0.02); }
inline Matrix6d second_covariance() { return covariance(2, 0.08, 0.03); }

inline ProjectedGaussian<SE3d> gaussian(const Eigen::Vector3d& rotation_vector,
                                        const Eigen::Vector3d& translation,
                                        const Matrix6d& covariance) {
  return {SE3d(SO3d::exp(rotation_vector), translation), covariance};
}

/// The largest difference of the quaternion (w, x, y, z), for either sign.
inline double quaternion_distance(const SO3d& rotation, const Eigen::Vector4d& wxyz) {
  const Eigen::Quaterniond& q = rotation.quaternion();
  const Eigen::Vector4d found(q.w(), q.x(), q.y(), q.z());
  return std::min((found - wxyz).cwiseAbs().maxCoeff(), (found + wxyz).cwiseAbs().maxCoeff());
}

}  // namespace posemix::oracle
