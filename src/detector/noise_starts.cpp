// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "detector/noise_rows.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/statistics.hpp"
#include "posemix/detector/noise_em.hpp"

namespace posemix {
namespace {

using internal::ResidualRows;

/// Weight of clutter at a start.
constexpr double kStartClutter = 0.25;

/// Spreads of the narrowest and the widest component of a start, relative to that of the residuals.
struct SpreadRange {
  double narrowest;
  double widest;
};

/// Root mean square of every coordinate, or, robust against gross errors, 1.4826 times the median
/// size.
Vector6d spread_of(const ResidualRows& rows, bool robust) {
  constexpr double kSdByMedianSize = 1.482602218505602;
  Vector6d spread;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const Eigen::ArrayXd sizes = rows.residuals().row(axis).cwiseAbs().transpose();
    spread[axis] = robust
                       ? kSdByMedianSize * median(std::span(sizes.data(), rows.residuals().cols()))
                       : std::sqrt(sizes.square().mean());
  }
  return spread;
}

/// Concentric components whose spreads are a geometric series. Every second start takes the robust
/// spread of the residuals, and from the third start on the spread of every coordinate is
/// multiplied by a random factor.
DetectorNoise concentric_start(const ResidualRows& rows, const NoiseEmSettings& settings,
                               int attempt, RandomStream& stream) {
  const bool robust = (attempt % 2 == 0) == settings.clutter;
  const SpreadRange range = robust ? SpreadRange{0.7, 4.0} : SpreadRange{0.25, 1.5};
  const Vector6d spread = spread_of(rows, robust);
  std::vector<NoiseComponent> components;
  for (std::size_t k = 0; k < settings.components; ++k) {
    const double part = settings.components == 1
                            ? 0.0
                            : static_cast<double>(k) / static_cast<double>(settings.components - 1);
    Vector6d sd = spread;
    if (settings.components > 1)
      sd *= range.narrowest * std::pow(range.widest / range.narrowest, part);
    if (attempt > 1) {
      for (double& each : sd) each *= std::exp(0.7 * stream.normal());
    }
    const Matrix6d second = sd.cwiseAbs2().asDiagonal();
    components.push_back({.weight = 1.0 / static_cast<double>(settings.components),
                          .covariance = bounded_covariance(second, settings.em),
                          .frame = settings.frame});
  }
  Clutter clutter{0.0, settings.clutter_volume_m3};
  if (settings.clutter) clutter.weight = kStartClutter / (1.0 - kStartClutter);
  return DetectorNoise(std::move(components), clutter);
}

}  // namespace

NoiseEmFit fit_noise_components(std::span<const NoiseObservation> observations,
                                const NoiseEmSettings& settings, RandomStream& stream) {
  require(settings.components > 0, "noise model: there are 0 components, expected one or more");
  if (settings.components > observations.size() / 2) {
    const auto plural = [](std::size_t count) { return count == 1 ? "" : "s"; };
    throw InvalidInput(
        fmt::format("noise model: {} observation{} for {} component{}, expected two per component",
                    observations.size(), plural(observations.size()), settings.components,
                    plural(settings.components)));
  }
  const ResidualRows rows(observations, settings.frame, SE3d());
  const bool convex = settings.components == 1 && !settings.clutter;
  const int attempts = convex ? 1 : std::max(1, settings.em.restarts);
  std::optional<NoiseEmFit> best;
  const auto rank = [](const NoiseEmFit& fit) {
    return std::pair(fit.status != EmStatus::degenerate, fit.log_likelihood);
  };
  for (int attempt = 0; attempt < attempts; ++attempt) {
    NoiseEmFit fit =
        refine_noise(observations, concentric_start(rows, settings, attempt, stream), settings);
    if (!best || rank(fit) > rank(*best)) best = std::move(fit);
  }
  return *std::move(best);
}

}  // namespace posemix
