// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/filter/update.hpp"

namespace posemix {

/// Settings of `iterated_update`.
struct IteratedUpdateSettings {
  int max_iterations = 12;
  double tolerance = 1e-7;  ///< stop when the step of the relative poses falls below this [rad, m]
};

/// Updates one hypothesis with several detections at once by iteration, keeping their common motion
/// exactly unobservable.
///
/// A detection knows nothing but a relative pose, Z_j = T_j^-1 T_R. The relative poses seen are
/// estimated by Gauss-Newton from their prior and the detections; everything else follows by
/// regression on them; and the new mean is composed from the pose of the first object seen and
/// relative poses: of the camera to it, of the other objects seen to the camera, of everything else
/// to the first object. Only that one pose is touched by the world's coordinates, so a common
/// motion of everything gains no information, while a reset of each pose's covariance by itself
/// would leak some. See docs/filter.md for the equations.
///
/// `first_object` is the index of the first object; poses between the camera and it (the motion of
/// the constant-velocity model) take no part in a common motion. The likelihood is Laplace's,
/// exp(-(zeta^T P^-1 zeta + n^T R^-1 n) / 2) / sqrt(det 2 pi (H P H^T + R)) at the solution.
UpdateResult iterated_update(const Hypothesis& prior, std::span<const Detection> detections,
                             std::span<const NoiseComponent* const> noise,
                             std::size_t first_object = 1,
                             const IteratedUpdateSettings& settings = {});

}  // namespace posemix
