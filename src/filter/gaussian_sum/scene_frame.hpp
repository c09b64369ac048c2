// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "posemix/filter/update.hpp"

/// Errors of poses are turns about the origin of the world. Far from it the covariance of an
/// innovation mixes those of a degree with those of a millimetre, and its factors lose the latter
/// to rounding: at ten kilometres all of them. Updates are computed near the scene there, which
/// changes no result in exact arithmetic: everything is invariant to where the world has its
/// origin.
namespace posemix::internal {

/// Where an update of these hypotheses has its origin: none, if that of the world is near enough.
std::optional<Eigen::Vector3d> scene_origin(const Posterior& posterior);

/// Moves the world by `shift`, T_new_old: all poses but those between the camera and the first
/// object, which are motions of the camera.
void move_world(const Eigen::Vector3d& shift, std::size_t first_object,
                std::vector<Component<Hypothesis>>& hypotheses);

}  // namespace posemix::internal
