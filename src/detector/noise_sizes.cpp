// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/noise_sizes.hpp"

#include <algorithm>
#include <utility>

#include "posemix/base/units.hpp"
#include "posemix/mixture/em.hpp"

namespace posemix::internal {
namespace {

using Density = ConcentratedGaussian<SE3d>;

/// Least standard deviation of a component by the greatest.
constexpr double kLeastSdShare = 5e-4;

/// X = Exp(xi) M is M Exp(n) with n in the axes of M: the component's offset and covariance.
DetectorNoise noise_of(const Mixture<Density>& mixture) {
  std::vector<NoiseComponent> components;
  for (std::size_t k = 0; k < mixture.size(); ++k) {
    const Density& density = mixture[k].density;
    components.push_back({.weight = mixture.weight(k),
                          .covariance = density.body_covariance(),
                          .offset = density.mean()});
  }
  std::sort(components.begin(), components.end(),
            [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return DetectorNoise(std::move(components));
}

/// Components that are offset poses, in the object's frame.
std::vector<NoiseEmFit> fit_free_means(std::span<const NoiseObservation> observations,
                                       const NoiseFitSettings& settings, RandomStream& stream) {
  std::vector<SE3d> samples;
  for (const NoiseObservation& each : observations)
    samples.push_back(each.truth.inverse() * each.detected);
  const EmSettings em = em_settings(settings, NoiseFrame::object, settings.max_components).em;
  std::vector<NoiseEmFit> fits;
  for (auto& fit : fit_mixture_by_bic<Density>(samples, {}, em, stream).fits) {
    fits.push_back({noise_of(fit.mixture), fit.log_likelihood, std::move(fit.history), fit.status,
                    fit.parameters, fit.bic});
  }
  return fits;
}

}  // namespace

NoiseEmSettings em_settings(const NoiseFitSettings& settings, NoiseFrame frame,
                            std::size_t components) {
  NoiseEmSettings fit{.components = components,
                      .frame = frame,
                      .clutter = settings.clutter,
                      .clutter_volume_m3 = settings.clutter_volume_m3,
                      .least_clutter = settings.least_clutter,
                      .em = {.components = components,
                             .restarts = settings.restarts,
                             .diagonal = !settings.full_covariance,
                             .unit = Eigen::VectorXd(6),
                             .min_sd = kLeastSdShare,
                             .max_sd = 1.0}};
  fit.em.unit.head<3>().setConstant(radians(settings.max_rotation_sd_deg));
  fit.em.unit.tail<3>().setConstant(settings.max_translation_sd_m);
  return fit;
}

std::vector<NoiseEmFit> fit_noise_sizes(std::span<const NoiseObservation> observations,
                                        const NoiseFitSettings& settings, NoiseFrame frame,
                                        RandomStream& stream) {
  if (settings.free_means) return fit_free_means(observations, settings, stream);
  std::vector<NoiseEmFit> fits;
  for (std::size_t k = 1; k <= settings.max_components; ++k) {
    if (k > 1 && observations.size() < (settings.full_covariance ? 7 : 2) * k) break;
    fits.push_back(fit_noise_components(observations, em_settings(settings, frame, k), stream));
  }
  return fits;
}

}  // namespace posemix::internal
