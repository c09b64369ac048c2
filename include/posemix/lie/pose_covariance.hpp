// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/linear.hpp"

namespace posemix {

/// Diagonal covariance of a pose from the standard deviations of the rotation about x, y, z [rad]
/// and of the translation along them [m].
inline Matrix6d pose_covariance(const Eigen::Vector3d& rotation_sd_rad,
                                const Eigen::Vector3d& translation_sd_m) {
  Vector6d sd;
  sd << rotation_sd_rad, translation_sd_m;
  return sd.cwiseAbs2().asDiagonal();
}

}  // namespace posemix
