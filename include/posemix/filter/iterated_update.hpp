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
/// A detection depends on a relative pose alone, Z_j = T_j^-1 T_R. The relative poses of the
/// detected objects are estimated by Gauss-Newton from their prior and the detections, and all
/// other coordinates follow by regression on them. The new mean is composed from the pose of the
/// first detected object and from relative poses: of the camera to that object, of the other
/// detected objects to the camera, and of all other poses to the first detected object. Only that
/// one pose depends on the world's coordinates, so a common motion of all poses gains no
/// information; a reset of each pose's covariance by itself would leak some. See docs/filter.md for
/// the equations.
///
/// `first_object` is the index of the first object. Poses between the camera and that index (the
/// motion of the constant-velocity model) take no part in a common motion. The likelihood is that
/// of Laplace's approximation, exp(-(zeta^T P^-1 zeta + n^T R^-1 n) / 2) / sqrt(det 2 pi (H P H^T +
/// R)) at the solution.
/// @throws InvalidInput when there are not as many components as detections
UpdateResult iterated_update(const Hypothesis& prior, std::span<const Detection> detections,
                             std::span<const NoiseComponent* const> noise,
                             std::size_t first_object = 1,
                             const IteratedUpdateSettings& settings = {});

}  // namespace posemix
