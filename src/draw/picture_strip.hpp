// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <vector>

#include "picture_curves.hpp"
#include "svg.hpp"

namespace posemix::internal {

/// The look of a strip.
struct StripStyle {
  std::string colour;
  std::string unit;            ///< of the error, for what is said of errors beyond the scale
  bool has_time_axis = false;  ///< whether the times are written below it
};

/// Draws an error over time. What is beyond the scale has a mark at the upper edge, and is counted.
void draw_error_strip(SvgDocument& svg, const SvgBox& box, const std::vector<double>& stamps,
                      const ErrorCurves& curves, const StripStyle& style);

/// Draws a probability over time.
void draw_probability_strip(SvgDocument& svg, const SvgBox& box, const std::vector<double>& stamps,
                            const Curve& curve, const StripStyle& style);

}  // namespace posemix::internal
