// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string_view>

#include "posemix/slam/run.hpp"

namespace posemix {

/// The names of the members of DetectionStatus in trace.json, in their order.
inline constexpr std::array<std::string_view, 7> kStatusNames{
    "none", "started", "used", "doubted", "birth", "gated", "failed"};

constexpr std::string_view status_name(DetectionStatus status) {
  return kStatusNames[static_cast<std::size_t>(status)];
}

/// The names of the release before, which traces are still read by.
inline constexpr std::string_view kOldStatusKey = "fate";
inline constexpr std::string_view kOldBirthName = "born";

}  // namespace posemix
