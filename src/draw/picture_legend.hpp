// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>

#include "posemix/draw/picture.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// An error of a pose, as "12.3 mm, 0.45 deg"; "-" for what is not known.
std::string pose_error_text(const std::optional<double>& metres,
                            const std::optional<double>& degrees);

/// Draws what the marks of the map mean, and the objects with their errors.
void draw_legend(SvgDocument& svg, const SvgBox& box, const SlamJob& job, const Metrics& metrics);

}  // namespace posemix::internal
