// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>

/// Conversions between degrees (files, messages) and radians (everywhere else).
namespace posemix {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Converts degrees to radians.
constexpr double radians(double degrees) { return degrees * kRadPerDeg; }

/// Converts radians to degrees.
constexpr double degrees(double radians) { return radians / kRadPerDeg; }

}  // namespace posemix
