// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix {

/// A camera of several on one body, the rig.
struct BodyCamera {
  std::string name;       ///< Observation::camera
  SE3d body_camera = {};  ///< T_body_camera
  /// Covariance of n of T_body_camera Exp(n), about and along the axes of the camera, rotation
  /// [rad] before translation [m]. The pose is then estimated with everything else. None or zero:
  /// it is exact. One camera of a rig should be, since the body is only known from where the
  /// cameras are.
  std::optional<Matrix6d> covariance = {};

  bool is_exact() const { return !covariance || covariance->isZero(0.0); }
  /// T_body_camera with its covariance, perturbed on the left in the frame of the body.
  /// @throws InvalidInput for an exact one
  ConcentratedGaussian<SE3d> prior() const;
};

/// Index of the camera with the name; none without any cameras.
/// @throws InvalidInput for another name, with those that there are
std::optional<std::size_t> index_of_camera(std::span<const BodyCamera> cameras,
                                           std::string_view name);

/// T_body_camera of the camera with the name, as it is stated. Without any cameras every name is
/// the body itself.
/// @throws InvalidInput for another name, with those that there are
SE3d pose_on_body(std::span<const BodyCamera> cameras, std::string_view name);

/// @throws InvalidInput when two cameras share a name, a pose is not finite, or a covariance is
/// neither zero nor symmetric and positive definite
void require_valid(std::span<const BodyCamera> cameras);

}  // namespace posemix
