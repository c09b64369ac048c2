// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "filter/world_shift.hpp"
#include "posemix/filter/gaussian_sum_filter.hpp"

namespace posemix::internal {

/// Where an update of these hypotheses has its origin, as WorldShift says why: none, if that of the
/// world is near enough.
std::optional<Eigen::Vector3d> scene_origin(const Posterior& posterior);

/// Moves all poses but those between the camera and the first object, which are motions of the
/// camera.
void move_world(const WorldShift& shift, std::size_t first_object,
                std::vector<Component<Hypothesis>>& hypotheses);

}  // namespace posemix::internal
