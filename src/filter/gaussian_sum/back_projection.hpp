// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/filter/update.hpp"

/// The last step of the iterated update.
namespace posemix::internal {

/// Moves a Gaussian N(xi, P) in the tangent space at `mean` to its own mean, pose by pose relative
/// to a parent p:
///   T_k <- T_p Exp(zeta_k) T_p^-1 T_k,  zeta_k = Ad(T_p^-1) (xi_k - xi_p),
///   xi_k <- xi_p + M_k (xi_k - xi_p),   M_k = Ad(T_p new) J_l(zeta_k) Ad(T_p^-1).
/// The first detected object is the anchor. The parent of the camera is the anchor, that of the
/// other detected objects is the camera, and that of every other object is the anchor. The anchor
/// itself and the poses between the camera and `first_object` (its motion) have no parent:
///   T_k <- Exp(xi_k) T_k,  xi_k <- J_l(xi_k) xi_k.
Hypothesis back_project_relative(const PoseStackd& mean, const Eigen::VectorXd& xi,
                                 Eigen::MatrixXd covariance, std::span<const Detection> detections,
                                 std::size_t first_object);

}  // namespace posemix::internal
