// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <concepts>
#include <span>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/density/operations.hpp"
#include "posemix/lie/bernoulli.hpp"
#include "posemix/mixture/mixture.hpp"

namespace posemix {

/// The Jacobian J_l^-1 by which a component's covariance is moved to another tangent space.
enum class TransportJacobian {
  exact,     ///< closed form
  bernoulli  ///< Bernoulli series up to the fourth power of ad, as in the program of the midway
             ///< paper
};

/// The words of TransportJacobian in files and options.
template <>
inline constexpr WordTable<TransportJacobian, 2> words<TransportJacobian>{{
    {"exact", TransportJacobian::exact},
    {"bernoulli", TransportJacobian::bernoulli},
}};

/// The component as a Gaussian in the tangent space at `anchor`, with the named Jacobian.
template <LieGroup G>
TangentGaussian<G> recenter(const ConcentratedGaussian<G>& density, const G& anchor,
                            TransportJacobian jacobian) {
  if (jacobian == TransportJacobian::exact) return recenter(density, anchor);
  const typename G::Tangent d = (density.mean() * anchor.inverse()).log();
  return {anchor, d, bernoulli_inverse_congruence<G>(d, density.covariance())};
}

namespace internal {

/// A weighted density and its position relative to an anchor: its mean is Exp(d) anchor.
template <LieGroup G>
struct SeenFrom {
  double weight;
  const ConcentratedGaussian<G>* density;
  typename G::Tangent d;
};

/// J_l^-1(d) P J_l^-T(d).
template <LieGroup G>
typename G::TangentMatrix transported(const SeenFrom<G>& seen, TransportJacobian jacobian) {
  const auto& p = seen.density->covariance();
  if (jacobian == TransportJacobian::exact) return G::left_jacobian_inverse_congruence(seen.d, p);
  typename G::TangentMatrix moved = bernoulli_inverse_congruence<G>(seen.d, p);
  symmetrize(moved);
  return moved;
}

/// sum_i w_i J_l^-1(d_i) P_i J_l^-T(d_i) + D D^T.
template <LieGroup G>
typename G::TangentMatrix sum_of_transported(std::span<const SeenFrom<G>> parts,
                                             const Eigen::MatrixXd& deviations,
                                             TransportJacobian jacobian) {
  if constexpr (std::same_as<G, PoseStackd>) {
    if (jacobian == TransportJacobian::exact) {
      std::vector<MovedCovariance> moved;
      moved.reserve(parts.size());
      for (const auto& part : parts)
        moved.push_back({&part.d, &part.density->covariance(), part.weight});
      return sum_of(moved, deviations);
    }
  }
  typename G::TangentMatrix sum = deviations * deviations.transpose();
  for (const auto& part : parts) sum += part.weight * transported(part, jacobian);
  return sum;
}

/// The moments of weighted densities in the tangent space at `anchor`; their d are relative to this
/// anchor. The weights sum to one.
template <LieGroup G>
TangentGaussian<G> moments_at(const G& anchor, std::span<const SeenFrom<G>> parts,
                              TransportJacobian jacobian) {
  const Eigen::Index n = anchor.dof();
  TangentGaussian<G> result{anchor, G::Tangent::Zero(n), {}};
  for (const SeenFrom<G>& part : parts) result.mean += part.weight * part.d;
  Eigen::MatrixXd deviations(n, static_cast<Eigen::Index>(parts.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    deviations.col(static_cast<Eigen::Index>(i)) =
        std::sqrt(parts[i].weight) * (parts[i].d - result.mean);
  }
  result.covariance = sum_of_transported(parts, deviations, jacobian);
  return result;
}

}  // namespace internal

/// Mean and covariance of a weighted sum of components in the tangent space at `anchor`, to which
/// every component is moved first (midway-merge paper, eq. 8, 13-15, 18; for two or more
/// components). The weights need not be normalised.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or all weights are
/// zero
template <LieGroup G>
TangentGaussian<G> tangent_moments(std::span<const Component<ConcentratedGaussian<G>>> components,
                                   const G& anchor,
                                   TransportJacobian jacobian = TransportJacobian::exact) {
  require(!components.empty(), "tangent_moments: there is no component");
  const internal::LogScale scale = internal::checked_log_scale(components);
  const G inverse = anchor.inverse();
  std::vector<internal::SeenFrom<G>> parts;
  parts.reserve(components.size());
  for (const auto& component : components) {
    const double weight = std::exp(scale(component.log_weight));
    if (weight == 0.0) continue;
    parts.push_back({weight, &component.density, (component.density.mean() * inverse).log()});
  }
  return internal::moments_at<G>(anchor, parts, jacobian);
}

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_TANGENT_MOMENTS(prefix, G)                                              \
  prefix template TangentGaussian<G> recenter(const ConcentratedGaussian<G>&, const G&, \
                                              TransportJacobian);                       \
  prefix template TangentGaussian<G> internal::moments_at(                              \
      const G&, std::span<const internal::SeenFrom<G>>, TransportJacobian);             \
  prefix template TangentGaussian<G> tangent_moments(                                   \
      std::span<const Component<ConcentratedGaussian<G>>>, const G&, TransportJacobian)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_TANGENT_MOMENTS(extern, SO3d);
POSEMIX_TANGENT_MOMENTS(extern, SE3d);
POSEMIX_TANGENT_MOMENTS(extern, PoseStackd);
POSEMIX_TANGENT_MOMENTS(extern, Rnd<3>);

}  // namespace posemix
