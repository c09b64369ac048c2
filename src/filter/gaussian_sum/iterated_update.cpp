// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/iterated_update.hpp"

#include <utility>

#include "back_projection.hpp"
#include "posemix/base/error.hpp"
#include "relative_poses.hpp"
#include "world_noise.hpp"

namespace posemix {
namespace {

using namespace internal;

template <int Dim>
UpdateResult update_in_relative_poses(const Hypothesis& prior,
                                      std::span<const Detection> detections,
                                      std::span<const NoiseComponent* const> noise,
                                      std::size_t first_object,
                                      const IteratedUpdateSettings& settings) {
  // The relative poses that the detections depend on.
  const RelativePrior<Dim> relative(prior, detections, noise);
  const RelativePosterior<Dim> solution = internal::estimate(relative, settings);
  if (!solution.ok) return {prior, solution.log_likelihood, false};

  // All other coordinates by regression on them, G = P D^T P_zz^-1, xi = G zeta:
  // P' = (I - G D) P, then P <- P' - (P' D^T - G S) G^T.
  const Tall<Dim> g = internal::times_inverse<Dim>(relative.cross, relative.factor);
  Eigen::MatrixXd covariance = prior.covariance();
  internal::subtract_symmetric_product(covariance, g, relative.cross);
  Tall<Dim> rest = relative.times_dt(covariance);
  internal::subtract_product(rest, g, solution.covariance);
  internal::subtract_symmetric_product(covariance, rest, g);
  return {internal::back_project_relative(prior.mean(), g * solution.zeta, std::move(covariance),
                                          detections, first_object),
          solution.log_likelihood, true};
}

}  // namespace

UpdateResult iterated_update(const Hypothesis& prior, std::span<const Detection> detections,
                             std::span<const NoiseComponent* const> noise, std::size_t first_object,
                             const IteratedUpdateSettings& settings) {
  require(noise.size() == detections.size(),
          "iterated update: not as many noise components as detections, expected one for each");
  if (detections.empty()) return {prior, 0.0, true};
  const internal::NoiseAtMean at_mean(prior.mean(), detections, noise);
  const auto components = at_mean.components();
  if (detections.size() == 1) {
    return update_in_relative_poses<6>(prior, detections, components, first_object, settings);
  }
  return update_in_relative_poses<Eigen::Dynamic>(prior, detections, components, first_object,
                                                  settings);
}

}  // namespace posemix
