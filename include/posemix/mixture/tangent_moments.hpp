// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/density/operations.hpp"
#include "posemix/lie/bernoulli.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix {

/// How J_l^-1 P J_l^-T is computed when a component is moved to another tangent space.
enum class TransportJacobian {
  exact,     ///< closed form
  bernoulli  ///< Bernoulli series up to the fourth power of ad, as in the midway authors' program
};

/// The component as a Gaussian in the tangent space at `anchor`, with the named Jacobian.
template <LieGroup G>
TangentGaussian<G> recenter(const ConcentratedGaussian<G>& density, const G& anchor,
                            TransportJacobian jacobian) {
  if (jacobian == TransportJacobian::exact) return recenter(density, anchor);
  const typename G::Tangent d = (density.mean() * anchor.inverse()).log();
  return {anchor, d, bernoulli_inverse_congruence<G>(d, density.covariance())};
}

/// Mean and covariance of a weighted sum of components in the tangent space at `anchor`, every
/// component moved there first (midway-merge paper, eq. 8, 13-15, 18; for two or more components).
/// The weights need not be normalised.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or all weights are
/// zero
template <LieGroup G>
TangentGaussian<G> tangent_moments(std::span<const Component<ConcentratedGaussian<G>>> components,
                                   const G& anchor,
                                   TransportJacobian jacobian = TransportJacobian::exact) {
  const Eigen::Index n = anchor.dof();
  require(!components.empty(), "tangent_moments: there is no component");
  const double log_total = checked_log_total(components);

  typename G::Tangent mean = G::Tangent::Zero(n);
  typename G::TangentMatrix second = G::TangentMatrix::Zero(n, n);
  for (const auto& component : components) {
    const double weight = std::exp(component.log_weight - log_total);
    if (weight == 0.0) continue;
    const TangentGaussian<G> moved = recenter(component.density, anchor, jacobian);
    mean += weight * moved.mean;
    second += weight * moved.covariance;
    second.noalias() += (weight * moved.mean) * moved.mean.transpose();
  }
  second.noalias() -= mean * mean.transpose();
  symmetrize(second);
  return {anchor, mean, second};
}

}  // namespace posemix
