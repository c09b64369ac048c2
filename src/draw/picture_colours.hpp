// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace posemix::internal {

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

}  // namespace posemix::internal
