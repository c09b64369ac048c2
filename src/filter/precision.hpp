// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "base/cholesky6.hpp"
#include "filter/world_shift.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/detector/detector_noise.hpp"
#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// A covariance in which variances differ by more than this loses its definiteness to rounding: a
/// double holds 4.5e15, of which the frames and the updates of a filter take their share.
inline constexpr double kLargestVarianceRatio = 1e13;

/// Largest standard deviation of a rotation that a prediction leaves, as all rotations are within a
/// turn [rad].
inline constexpr double kWidestRotation_rad = 100.0;

/// The same of a position, for a detector [m]: beyond, a double holds nothing of what is seen next.
inline double position_reach(const DetectorNoise& noise) {
  constexpr double kReach = 1e6;
  constexpr double kLeastReach_m = 10.0;
  double least = std::numeric_limits<double>::infinity();
  for (const NoiseComponent& component : noise.components())
    least = std::min(least, component.covariance.diagonal().tail<3>().minCoeff());
  return std::max(kReach * std::sqrt(least), kLeastReach_m);
}

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

/// Farther from the origin a prior of GaussianSumFilter is refused [m].
inline constexpr double kFarthestPrior = 1e5;

/// @throws InvalidInput when a pose is farther from the origin of the world than kFarthestPrior.
/// `name` begins the message.
inline void require_near_origin(const SE3d& pose, std::string_view name) {
  const double distance = pose.translation().norm();
  if (!(distance > kFarthestPrior)) return;
  throw InvalidInput(
      fmt::format("{} is {:.3g} km from the origin of the world; expected at most {:g} km, up to "
                  "which double precision holds its errors: put the origin near the scene",
                  name, distance / 1000.0, kFarthestPrior / 1000.0));
}

/// Whether rounding leaves something of the errors of a pose, far from the origin.
inline bool is_precise(const ConcentratedGaussian<SE3d>& pose) {
  if (!(pose.mean().translation().norm() > kFarFromOrigin_m)) return true;
  const auto there = seen_from_near(pose);
  const double stated = pose.covariance().diagonal().tail<3>().maxCoeff();
  const double left = there.covariance().diagonal().tail<3>().minCoeff();
  return left * kLargestVarianceRatio > stated && Cholesky6(there.covariance()).ok();
}

/// @throws InvalidInput when rounding leaves nothing of the errors of a pose that is far from the
/// origin, which is `origin`. `name` begins the message, `expected` ends it.
inline void require_precise(const ConcentratedGaussian<SE3d>& pose, std::string_view name,
                            std::string_view origin = "the origin of the world",
                            std::string_view expected = "a world whose origin is near the scene") {
  if (is_precise(pose)) return;
  throw InvalidInput(fmt::format(
      "{} is {:.3g} km from {}, where double precision holds no covariance of it that has a "
      "standard deviation of {:.3g} m; expected {}",
      name, pose.mean().translation().norm() / 1000.0, origin,
      std::sqrt(pose.covariance().diagonal().tail<3>().maxCoeff()), expected));
}

}  // namespace posemix::internal
