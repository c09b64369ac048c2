// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// A covariance in which variances differ by more than this loses its definiteness to rounding: a
/// double holds 4.5e15, of which the frames and the updates of a filter take their share.
inline constexpr double kLargestVarianceRatio = 1e13;

/// @throws InvalidInput when a pose is so uncertain before a detection that the noise of the
/// detection is lost in its rounding. Rotations are compared with rotations [rad], positions with
/// positions [m]. `name` begins the message.
inline void require_precision(const Matrix6d& predicted, const Matrix6d& noise,
                              std::string_view name) {
  for (const int at : {0, 3}) {
    const double before = predicted.diagonal().segment<3>(at).maxCoeff();
    const double seen = noise.diagonal().segment<3>(at).minCoeff();
    if (!(before > kLargestVarianceRatio * seen)) continue;
    const char* unit = at == 0 ? "rad" : "m";
    throw InvalidInput(fmt::format(
        "{} has a standard deviation of {:.3g} {} and the detection one of {:.3g} {}; expected at "
        "most {:.1e} times as much, which double precision holds",
        name, std::sqrt(before), unit, std::sqrt(seen), unit, std::sqrt(kLargestVarianceRatio)));
  }
}

/// Errors are turns about the origin of the world: far from it, those of millimetres are lost in
/// the rounding of those of a degree. Up to these distances [m] the results are those near the
/// origin.
inline constexpr double kFarthestScene = 1e4;             ///< of MultiObjectFilter
inline constexpr double kFarthestGaussianSumScene = 1e5;  ///< of GaussianSumFilter

/// @throws InvalidInput when a pose of a camera or an object is farther from the origin of the
/// world than `farthest` [m]. `name` begins the message.
inline void require_near_origin(const SE3d& pose, double farthest, std::string_view name) {
  const double distance = pose.translation().norm();
  if (!(distance > farthest)) return;
  throw InvalidInput(
      fmt::format("{} is {:.3g} km from the origin of the world; expected at most {:g} km, up to "
                  "which double precision holds its errors: put the origin near the scene",
                  name, distance / 1000.0, farthest / 1000.0));
}

}  // namespace posemix::internal
