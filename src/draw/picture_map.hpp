// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "posemix/draw/picture.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// Draws the map of camera path and objects.
void draw_map(SvgDocument& svg, const SvgBox& box, const SlamJob& job, const SlamRun& run);

/// Draws the mark of a true object position.
void draw_cross(SvgDocument& svg, const Eigen::Vector2d& at);

}  // namespace posemix::internal
