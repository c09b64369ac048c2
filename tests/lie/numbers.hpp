// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <limits>
#include <numbers>

/// The numbers at which Lie-group code goes wrong first.
namespace posemix::testing {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace posemix::testing
