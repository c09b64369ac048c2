// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// E[R(u)] with R(u) = ((1 - u.u) I + 2 u u^T + 2 [u]x) / (1 + u.u), of E[1 / (1 + u.u)] and of the
/// first and second moments of u with this factor.
inline Eigen::Matrix3d mean_rotation(double weight, const Eigen::Vector3d& first,
                                     const Eigen::Matrix3d& second) {
  Eigen::Matrix3d rotation = 2.0 * second;
  rotation.diagonal().array() += weight - second.trace();
  return rotation + 2.0 * SO3d::hat(first);
}

}  // namespace posemix::internal
