// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/density/concentrated_gaussian.hpp"

namespace posemix::internal {

/// Covariance [m^2] of the position of a pose in its reference frame, to first order: the error of
/// the position t of Exp(xi) X0 is rho + phi x t.
inline Eigen::Matrix3d position_covariance(const ConcentratedGaussian<SE3d>& density) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << -SO3d::hat(density.mean().translation()), Eigen::Matrix3d::Identity();
  return jacobian * density.covariance() * jacobian.transpose();
}

}  // namespace posemix::internal
