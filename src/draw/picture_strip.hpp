// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/draw/picture.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// One number per frame of one object; empty for a frame without a value.
using Curve = std::vector<std::optional<double>>;

/// The curves in the strip of one object [deg].
struct StripCurves {
  Curve estimate;  ///< rotation error of the estimate; empty without ground truth
  Curve detector;  ///< rotation error of the detections
  Curve width;     ///< 3 sigma about the least certain axis
};

StripCurves strip_curves(const SlamJob& job, const SlamRun& run, std::size_t object);

/// Draws the strip of one object over time; the last of several has the time axis.
void draw_strip(SvgDocument& svg, const SvgBox& box, const SlamJob& job, std::size_t object,
                const StripCurves& curves, bool last);

}  // namespace posemix::internal
