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

/// Mean and covariance of a weighted sum of components in the tangent space at `anchor`, every component moved there
/// first (midway-merge paper, eq. 8, 13-15, 18; for two or more components). The weights need not be normalised.
template <LieGroup G>
TangentGaussian<G> tangent_moments(std::span<const Component<ConcentratedGaussian<G>>> components,
                                   const G& anchor,
                                   TransportJacobian jacobian = TransportJacobian::exact) {
  const Eigen::Index n = anchor.dof();
  double largest = components.front().log_weight;
  for (const auto& component : components) largest = std::max(largest, component.log_weight);

  double total = 0.0;
  typename G::Tangent mean = G::Tangent::Zero(n);
  typename G::TangentMatrix second = G::TangentMatrix::Zero(n, n);
  for (const auto& component : components) {
    const double weight = std::exp(component.log_weight - largest);
    if (weight == 0.0) continue;
    const TangentGaussian<G> moved = recenter(component.density, anchor, jacobian);
    total += weight;
    mean += weight * moved.mean;
    second += weight * moved.covariance;
    second.noalias() += (weight * moved.mean) * moved.mean.transpose();
  }
  mean /= total;
  second /= total;
  second.noalias() -= mean * mean.transpose();
  symmetrize(second);
  return {anchor, mean, second};
}

}  // namespace posemix
