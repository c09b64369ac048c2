// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "rotation_ray.hpp"

namespace posemix::internal {

/// The common axis of symmetry of two mixtures: every mean is reached from every other by a
/// rotation about it, and every covariance is a I + b (axis axis^T), both up to 1e-11 of the
/// standard deviations. Empty if there is none.
std::optional<Eigen::Vector3d> common_axis(const RotationPair& pair);

}  // namespace posemix::internal
