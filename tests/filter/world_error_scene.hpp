// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Eigenvalues>

#include "scenario.hpp"

/// What the tests of the error of the world share.
namespace posemix::testing {

/// Of the camera at the start.
inline const Matrix6d& start_covariance() {
  static const Matrix6d covariance = isotropic(0.5, 0.005);
  return covariance;
}

inline bool is_at_least(const Matrix6d& covariance, const Matrix6d& least) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance - least).eigenvalues().minCoeff() > 0.0;
}

}  // namespace posemix::testing
