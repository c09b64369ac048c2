// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <string_view>

#include "posemix/slam/run.hpp"

namespace posemix {

/// What trace.json calls the members of DetectionFate, in their order.
inline constexpr std::array<std::string_view, 7> kFateNames{"none", "started", "used",  "doubted",
                                                            "born", "gated",   "failed"};

constexpr std::string_view fate_name(DetectionFate fate) {
  return kFateNames[static_cast<std::size_t>(fate)];
}

}  // namespace posemix
