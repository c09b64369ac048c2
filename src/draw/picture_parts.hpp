// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posemix/draw/picture.hpp"
#include "svg.hpp"

/// The parts of picture.svg.
namespace posemix {

/// Colours that colour-blind readers can distinguish (Okabe and Ito 2008).
inline constexpr std::array<std::string_view, 6> kObjectColours{"#D55E00", "#0072B2", "#009E73",
                                                                "#CC79A7", "#E69F00", "#56B4E9"};
inline constexpr std::string_view kCameraColour = "#222222";
inline constexpr std::string_view kTruthColour = "#8A8A8A";
inline constexpr std::string_view kGridColour = "#E4E4E4";
inline constexpr std::string_view kAxisColour = "#555555";

inline std::string object_colour(std::size_t object) {
  return std::string(kObjectColours[object % kObjectColours.size()]);
}

/// The map of camera path and objects.
void draw_map(SvgDocument& svg, const SvgBox& box, const SlamJob& job, const SlamRun& run);

/// The mark of a true object position.
void draw_cross(SvgDocument& svg, const Eigen::Vector2d& at);

/// One number per frame of one object; empty for a frame without a value.
using Curve = std::vector<std::optional<double>>;

/// The curves in the strip of one object [deg].
struct StripCurves {
  Curve estimate;  ///< rotation error of the estimate; empty without ground truth
  Curve detector;  ///< rotation error of the detections
  Curve width;     ///< 3 sigma about the least certain axis
};

StripCurves strip_curves(const SlamJob& job, const SlamRun& run, std::size_t object);

/// The strip of one object over time; the last of several has the time axis.
void draw_strip(SvgDocument& svg, const SvgBox& box, const SlamJob& job, std::size_t object,
                const StripCurves& curves, bool last);

}  // namespace posemix
