// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "posemix/divergence/gaussian.hpp"
#include "posemix/divergence/monte_carlo.hpp"
#include "posemix/divergence/projected.hpp"

/// The loss of a reduction: bounds from the components alone, and measured divergence.
namespace posemix {

/// Destination of a component that was dropped.
inline constexpr std::size_t kDropped = std::numeric_limits<std::size_t>::max();

/// Bounds on the loss of a reduction from M to M'. First the dropped components, of total weight
/// lambda, are removed from M, and the rest is renormalised to D; then every component p_i of D,
/// with weight l_i, becomes a part of one component p'_j(i) of M'. Because Kullback-Leibler
/// divergences are jointly convex,
///   D(D || M') <= sum_i l_i D(p_i || p'_j(i)),
/// and the same holds for D(M' || D) and for the sum of both. This is eq. 24 of the MPG paper
/// without its factor 1 / (l_1 + l_2), for any number of merges in a row. On R^n these are bounds;
/// on other groups the divergences of the components are those of Gaussians (or of the
/// distributions, for projected Gaussians) in a common tangent space, which is first order.
struct BoundedLoss {
  /// Bound on |P(B) - P'(B)| over all sets B caused by the dropping: lambda. (The MPG paper has 2
  /// lambda.)
  double dropped = 0.0;
  double merged_kl = 0.0;            ///< D(D || M') <= sum_i l_i D(p_i || p'_j(i)) [nats]
  double merged_symmetric_kl = 0.0;  ///< D(D || M') + D(M' || D) [nats]
  /// Bound on |P(B) - P'(B)| over all sets B for the whole reduction: lambda + sqrt(merged_kl / 2)
  /// by Pinsker's inequality, at most one.
  double total_variation = 0.0;
  /// Bound on D(M' || M) of the whole reduction [nats]: M contains D with the weight 1 - lambda,
  /// which adds -log(1 - lambda). (No function of lambda alone bounds D(M || M').)
  double kl_from_reduced = 0.0;
};

namespace internal {

template <LieGroup G>
double component_kl(const ConcentratedGaussian<G>& p, const ConcentratedGaussian<G>& q) {
  return gaussian_kl(p, q);
}
template <RotationOrPose G>
double component_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  return exact_kl(p, q);
}

}  // namespace internal

/// The bounds on a reduction from `before` to `after` in which component i became a part of
/// component destination[i], or was dropped (kDropped).
/// @throws InvalidInput when there is not one destination for every component, or a destination
/// does not exist
template <class D>
BoundedLoss bounded_loss(std::span<const Component<D>> before, const Mixture<D>& after,
                         std::span<const std::size_t> destination) {
  if (destination.size() != before.size()) {
    throw InvalidInput(fmt::format("bounded_loss: {} destinations for {} components",
                                   destination.size(), before.size()));
  }
  BoundedLoss loss;
  double kept = 0.0;
  double backward = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double weight = std::exp(before[i].log_weight);
    if (destination[i] == kDropped) {
      loss.dropped += weight;
      continue;
    }
    require(destination[i] < after.size(), "bounded_loss: a destination does not exist");
    kept += weight;
    if (weight == 0.0) continue;
    const D& merged = after[destination[i]].density;
    loss.merged_kl += weight * std::max(0.0, internal::component_kl(before[i].density, merged));
    backward += weight * std::max(0.0, internal::component_kl(merged, before[i].density));
  }
  loss.merged_kl /= kept;
  backward /= kept;
  loss.merged_symmetric_kl = loss.merged_kl + backward;
  loss.total_variation = std::min(1.0, loss.dropped + std::sqrt(0.5 * loss.merged_kl));
  loss.kl_from_reduced = backward - std::log1p(-loss.dropped);
  return loss;
}

/// The Kullback-Leibler divergence D(before || after) that a reduction caused [nats], by
/// `kl_monte_carlo`.
template <class D>
DivergenceEstimate measured_loss(const Mixture<D>& before, const Mixture<D>& after,
                                 RandomStream& stream,
                                 const DivergenceSamplingSettings& settings = {}) {
  return kl_monte_carlo(before, after, stream, settings);
}

}  // namespace posemix
