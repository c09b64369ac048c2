// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>

#include "posemix/base/units.hpp"
#include "posemix/grasp/tolerance_region.hpp"

/// Layout and units of a region's parameters.
namespace posemix::internal {

inline constexpr int kCentre = 0;
inline constexpr int kLogWidth = 6;
inline constexpr int kLogSoftness = 12;
inline constexpr int kLogitInside = 13;
inline constexpr int kLogitRatio = 14;
inline constexpr int kLever = 15;

inline constexpr double kMillimetre = 1e-3;

/// One degree about and one millimetre along each axis.
inline const Vector6d kUnits =
    (Vector6d() << Eigen::Vector3d::Constant(kRadPerDeg), Eigen::Vector3d::Constant(kMillimetre))
        .finished();

inline double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// log logistic(x) without overflow.
inline double log_logistic(double x) {
  return x > 0.0 ? -std::log1p(std::exp(-x)) : x - std::log1p(std::exp(x));
}

inline double logit(double p) { return std::log(p) - std::log1p(-p); }

}  // namespace posemix::internal
