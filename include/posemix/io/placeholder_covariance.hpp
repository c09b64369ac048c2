// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/linear.hpp"

namespace posemix {

/// Whether the numbers stand where there is no covariance. Detectors that know none fill the field:
/// with zeros, with the identity matrix, or with -1 as its first number, which is the convention of
/// ROS. All files and messages with poses of detectors are read by this rule.
bool is_placeholder_covariance(const Matrix6d& covariance);

}  // namespace posemix
