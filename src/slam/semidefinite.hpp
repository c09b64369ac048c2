// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Eigenvalues>

#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// The covariance without what rounding makes negative.
inline Matrix6d semidefinite(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(0.5 * (covariance + covariance.transpose()));
  const Matrix6d& v = eigen.eigenvectors();
  return mirror_upper(Matrix6d(v * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * v.transpose()));
}

}  // namespace posemix::internal
