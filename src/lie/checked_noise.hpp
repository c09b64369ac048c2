// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

#include "posemix/base/linear.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix::internal {

/// The symmetric part of the covariance of a noise, which is what check_noise judges: what only
/// one of two mirror images says may be more than the variances beside it.
/// @throws InvalidInput as check_noise
inline Matrix6d checked_noise(Matrix6d covariance, std::string_view name) {
  check_noise(covariance, name);
  symmetrize(covariance);
  return covariance;
}

}  // namespace posemix::internal
