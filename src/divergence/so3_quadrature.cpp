// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/so3_quadrature.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ball_integral.hpp"
#include "rotation_axis.hpp"

namespace posemix {
namespace internal {
namespace {

/// Rounding of a log density.
constexpr double kLogRounding = 4e-15;
/// Where int p log(p/q) is below this share of int p |log(p/q)|, the non-negative form is used.
constexpr double kCancellation = 0.05;

RotationPair checked_pair(const RotationDensity& p, const RotationDensity& q,
                          const RotationQuadratureSettings& settings) {
  if (!(settings.relative_tolerance > 0.0)) {
    throw InvalidInput(fmt::format("relative_tolerance is {}, expected a number > 0",
                                   settings.relative_tolerance));
  }
  return {rotation_peaks(p), rotation_peaks(q)};
}

/// Refines until the error falls below the tolerance or below what rounding allows.
DivergenceEstimate refined(BallIntegral& integral, double peak_density,
                           const RotationQuadratureSettings& settings) {
  const auto rounding = [&](double value) {
    return kLogRounding * std::sqrt(2.0 * std::abs(value) * peak_density) +
           kLogRounding * kLogRounding * peak_density;
  };
  const auto done = [&] {
    const RayIntegral& total = integral.total();
    return total.error <=
           std::max(settings.relative_tolerance * std::abs(total.value), rounding(total.value));
  };
  while (!done() && integral.total().evaluations < settings.max_evaluations) integral.refine();
  const RayIntegral& total = integral.total();
  return {total.value, total.error + rounding(total.value), total.evaluations, done()};
}

double largest_density(const RotationPair& pair) {
  double largest = 0.0;
  for (const auto* side : {&pair.p, &pair.q}) {
    for (const RotationPeak& peak : *side) largest = std::max(largest, std::exp(peak.log_scale));
  }
  return largest;
}

}  // namespace
}  // namespace internal

DivergenceEstimate kl(const RotationDensity& p, const RotationDensity& q,
                      const RotationQuadratureSettings& settings) {
  using namespace internal;
  const RotationPair pair = checked_pair(p, q, settings);
  const auto axis = common_axis(pair);
  std::size_t spent = 0;
  {
    BallIntegral direct(pair, log_ratio, false, axis, settings.relative_tolerance);
    if (std::abs(direct.total().value) >= kCancellation * direct.total().absolute) {
      return refined(direct, 1.0, settings);
    }
    spent = direct.total().evaluations;
  }
  BallIntegral gap(pair, gap_factor, true, axis, settings.relative_tolerance);
  DivergenceEstimate estimate = refined(gap, 1.0, settings);
  const double allowed = settings.relative_tolerance * std::abs(estimate.value);
  const RayIntegral masses = missing_mass_gap(pair, 0.1 * allowed);
  estimate.value += masses.value;
  estimate.error += masses.error;
  estimate.evaluations += spent;
  estimate.converged = estimate.converged && masses.error <= allowed;
  return estimate;
}

DivergenceEstimate symmetric_kl(const RotationDensity& p, const RotationDensity& q,
                                const RotationQuadratureSettings& settings) {
  using namespace internal;
  const RotationPair pair = checked_pair(p, q, settings);
  BallIntegral integral(pair, symmetric_factor, true, common_axis(pair),
                        settings.relative_tolerance);
  return refined(integral, 1.0, settings);
}

DivergenceEstimate isd(const RotationDensity& p, const RotationDensity& q,
                       const RotationQuadratureSettings& settings) {
  using namespace internal;
  const RotationPair pair = checked_pair(p, q, settings);
  BallIntegral integral(pair, square_factor, true, common_axis(pair), settings.relative_tolerance);
  return refined(integral, largest_density(pair), settings);
}

}  // namespace posemix
