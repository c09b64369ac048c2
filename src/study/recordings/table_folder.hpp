// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

namespace posemix {

/// The tables of estimates, ycbv_ESTIMATOR.csv.
inline constexpr std::string_view kTableFolder = "consensus-driven-uncertainty";

}  // namespace posemix
