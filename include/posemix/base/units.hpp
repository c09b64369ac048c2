// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>

/// Conversions between degrees (files, messages) and radians (everywhere else).
namespace posemix {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Angle in radians of an angle in degrees.
constexpr double radians(double degrees) { return degrees * kRadPerDeg; }

/// Angle in degrees of an angle in radians.
constexpr double degrees(double radians) { return radians / kRadPerDeg; }

}  // namespace posemix
