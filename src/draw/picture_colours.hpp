// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

/// The colours of all pictures. The page has the same (report/src/ui/palette.ts), and the plots of
/// the Python package (python/posemix/plot/palette.py); a test compares them.
namespace posemix::internal {

/// Objects and series, by their number, which readers with any colour vision can distinguish, and
/// which have a contrast of at least three on white. None is like an axis or the ground truth.
inline constexpr std::array<std::string_view, 10> kObjectColours{
    "#AA9117", "#B12CBE", "#296E79", "#DC68B5", "#4B9BCF",
    "#856224", "#9079FE", "#A27558", "#9249EB", "#CD3BA2"};
/// x, y and z, and nothing else.
inline constexpr std::array<std::string_view, 3> kAxisColours{"#D8232A", "#1E8E3E", "#2F62DC"};
inline constexpr std::string_view kCameraColour = "#222222";
inline constexpr std::string_view kTruthColour = "#8A8A8A";
inline constexpr std::string_view kGridColour = "#E4E4E4";
/// Lines and texts around a drawing.
inline constexpr std::string_view kAxisColour = "#555555";

inline std::string object_colour(std::size_t object) {
  return std::string(kObjectColours[object % kObjectColours.size()]);
}

}  // namespace posemix::internal
