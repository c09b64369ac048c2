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

/// If a smooth integrand cancels to less than this share, the non-negative form is used.
constexpr double kCancellation = 0.05;
/// So many rounding errors are nothing but noise.
constexpr double kNoise = 10.0;

RotationPair checked_pair(const RotationDensity& p, const RotationDensity& q,
                          const RotationQuadratureSettings& settings) {
  if (!(settings.relative_tolerance > 0.0)) {
    throw InvalidInput(fmt::format("relative_tolerance is {}, expected a number > 0",
                                   settings.relative_tolerance));
  }
  return {rotation_peaks(p), rotation_peaks(q)};
}

/// Refines until the error is below the tolerance or below the rounding error.
DivergenceEstimate refined(BallIntegral& integral, double peak_density,
                           const RotationQuadratureSettings& settings) {
  const Integrand positive{nullptr, peak_density, true};
  const auto rounding = [&](double value) { return positive.rounding(std::abs(value)); };
  const RayIntegral& total = integral.total();
  const auto allowed = [&] {
    return std::max(settings.relative_tolerance * std::abs(total.value), rounding(total.value));
  };
  while (!(total.error <= allowed()) && total.evaluations < settings.max_evaluations) {
    integral.refine(allowed());
  }
  return {total.value, total.error + rounding(total.value), total.evaluations,
          total.error <= allowed()};
}

double largest_density(const RotationPair& pair) {
  double largest = 0.0;
  for (const auto* side : {&pair.p, &pair.q}) {
    for (const RotationPeak& peak : *side) largest = std::max(largest, std::exp(peak.log_scale));
  }
  return largest;
}

/// An integral, and which of its two forms was used.
struct BestForm {
  DivergenceEstimate estimate;
  bool lacks_masses;  ///< the non-negative form was used, without the difference of the masses
};

/// Computes an integral by its smooth form, or if that cancels by the non-negative one.
BestForm best_of(const RotationPair& pair, DensityFactor smooth, Centres centres,
                 DensityFactor positive, double peak_density,
                 const RotationQuadratureSettings& settings) {
  const auto axis = common_axis(pair);
  const Integrand linear{smooth, peak_density, false};
  BallIntegral direct(pair, linear, centres, axis, settings.relative_tolerance);
  const RayIntegral first = direct.total();
  const bool is_noise = first.absolute < kNoise * linear.rounding(first.absolute);
  if (!is_noise && !(std::abs(first.value) < kCancellation * first.absolute)) {
    return {refined(direct, peak_density, settings), false};
  }
  BallIntegral gap(pair, {positive, peak_density, true}, Centres::mean, axis,
                   settings.relative_tolerance);
  DivergenceEstimate estimate = refined(gap, peak_density, settings);
  estimate.evaluations += first.evaluations;
  // Where the densities are the same, so are the masses that they miss.
  return {estimate, !is_noise};
}

}  // namespace
}  // namespace internal

DivergenceEstimate kl(const RotationDensity& p, const RotationDensity& q,
                      const RotationQuadratureSettings& settings) {
  using namespace internal;
  const RotationPair pair = checked_pair(p, q, settings);
  auto [estimate, lacks_masses] =
      best_of(pair, log_ratio, Centres::of_p, gap_factor, 1.0, settings);
  if (!lacks_masses) return estimate;
  const double allowed = settings.relative_tolerance * std::abs(estimate.value);
  const RayIntegral masses = missing_mass_gap(pair, 0.1 * allowed);
  estimate.value += masses.value;
  estimate.error += masses.error;
  estimate.converged = estimate.converged && masses.error <= allowed;
  return estimate;
}

DivergenceEstimate symmetric_kl(const RotationDensity& p, const RotationDensity& q,
                                const RotationQuadratureSettings& settings) {
  using namespace internal;
  return best_of(checked_pair(p, q, settings), log_ratio, Centres::difference, symmetric_factor,
                 1.0, settings)
      .estimate;
}

DivergenceEstimate isd(const RotationDensity& p, const RotationDensity& q,
                       const RotationQuadratureSettings& settings) {
  using namespace internal;
  const RotationPair pair = checked_pair(p, q, settings);
  return best_of(pair, density_gap, Centres::difference, square_factor, largest_density(pair),
                 settings)
      .estimate;
}

}  // namespace posemix
