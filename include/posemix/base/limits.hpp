// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/range.hpp"

/// The largest numbers that files and filters take. What lies beyond is in a wrong unit, and its
/// powers would overflow.
namespace posemix {

inline constexpr double kFarthestPosition = 1e8;  ///< of a coordinate [m]
inline constexpr double kLargestVariance = 1e16;  ///< on the diagonal of a covariance [rad^2, m^2]
inline constexpr double kLatestStamp = 1e12;      ///< of a stamp, and the longest step [s]

inline constexpr NumberRange kStamp{.lowest = -kLatestStamp, .highest = kLatestStamp};
inline constexpr NumberRange kTimeStep{.lowest = 0, .highest = kLatestStamp};
/// In radians or metres, and per any time.
inline constexpr NumberRange kStandardDeviation{.lowest = 0, .highest = 1e8};

}  // namespace posemix
