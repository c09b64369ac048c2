// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/grasp/tolerance_region.hpp"

#include <cmath>

#include <fmt/format.h>

#include "grasp/region_parameters.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/units.hpp"

namespace posemix {
namespace {

using namespace internal;

}  // namespace

double ToleranceRegion::success_probability(const Eigen::Vector3d& rotation,
                                            const Eigen::Vector3d& translation) const {
  Vector6d x;
  x << rotation, translation + rotation.cross(lever);
  double box = 1.0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double from_low = x[k] - centre[k] + half_width[k];
    const double from_high = centre[k] + half_width[k] - x[k];
    if (softness > 0.0 && std::isfinite(half_width[k])) {
      const double scale = 1.0 / (softness * half_width[k]);
      box /= (1.0 + std::exp(-scale * from_low)) * (1.0 + std::exp(-scale * from_high));
    } else if (from_low < 0.0 || from_high < 0.0) {
      return success_outside;
    }
  }
  return success_outside + (success_inside - success_outside) * box;
}

void validate(const ToleranceRegion& region) {
  for (const double w : region.half_width) {
    if (!(w > 0.0)) throw InvalidInput(fmt::format("half width {}, expected a positive one", w));
  }
  if (!(region.softness >= 0.0)) {
    throw InvalidInput(fmt::format("softness {}, expected one >= 0", region.softness));
  }
  const double outside = region.success_outside;
  const double inside = region.success_inside;
  if (!(0.0 <= outside && outside <= inside && inside <= 1.0)) {
    throw InvalidInput(fmt::format(
        "probabilities of success {} outside and {} inside, expected 0 <= outside <= inside <= 1",
        outside, inside));
  }
}

RegionParameters parameters_of(const ToleranceRegion& region) {
  validate(region);
  RegionParameters theta;
  theta.segment<6>(kCentre) = region.centre.cwiseQuotient(kUnits);
  theta.segment<6>(kLogWidth) = region.half_width.cwiseQuotient(kUnits).array().log();
  theta[kLogSoftness] = std::log(region.softness);
  theta[kLogitInside] = logit(region.success_inside);
  theta[kLogitRatio] = logit(region.success_outside / region.success_inside);
  theta.segment<3>(kLever) = region.lever / kMillimetre;
  if (!theta.allFinite()) {
    throw InvalidInput(
        "a region with hard walls, infinite widths or certain outcomes has no "
        "finite parameters");
  }
  return theta;
}

ToleranceRegion region_of(const RegionParameters& theta) {
  const double inside = logistic(theta[kLogitInside]);
  return {.centre = theta.segment<6>(kCentre).cwiseProduct(kUnits),
          .half_width = theta.segment<6>(kLogWidth).array().exp().matrix().cwiseProduct(kUnits),
          .softness = std::exp(theta[kLogSoftness]),
          .lever = theta.segment<3>(kLever) * kMillimetre,
          .success_inside = inside,
          .success_outside = inside * logistic(theta[kLogitRatio])};
}

}  // namespace posemix
