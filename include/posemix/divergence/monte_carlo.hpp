// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include "posemix/base/random.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/divergence/estimate.hpp"
#include "posemix/mixture/operations.hpp"

/// Divergences between mixtures on any group by randomised quasi-Monte Carlo: importance sampling
/// with Sobol points, stratified over the components, and digital shifts from the random stream
/// \cite lecuyer2002randomized. The error is one standard error over independent replicates; the
/// estimates are unbiased. Tangent vectors of concentrated Gaussians that rotate by more than pi
/// carry no mass, as in the quadrature on SO(3). Points of projected Gaussians are drawn from the
/// Gaussian in the tangent space and weighted by the ratio of the distribution to that Gaussian.
///
/// Compiled for concentrated Gaussians on SO3d, SE3d, PoseStackd and Rnd<Eigen::Dynamic>, for
/// projected Gaussians on SO3d and SE3d, and there for one kind against the other.
namespace posemix {

/// The number of points.
struct DivergenceSamplingSettings {
  /// Number of points in all. They are divided among the components by weight in every replicate; a
  /// component gets at least 16 of them, or fewer, but at least one, if there are not enough for
  /// all.
  std::size_t samples = 1 << 16;
  std::size_t replicates = 32;  ///< independent randomisations, at least 2
};

/// Kullback-Leibler divergence D(p || q) [nats], sampled from p. Projected Gaussians integrate to
/// one, so their divergence is sampled from (p + q) / 2 as int (p log(p/q) - p + q), whose
/// integrand is never negative.
/// @throws InvalidInput when sizes differ, there are less than 2 replicates, or fewer samples than
/// replicates
template <class P, class Q>
DivergenceEstimate kl_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                                  const DivergenceSamplingSettings& settings = {});

/// D(p || q) + D(q || p) [nats], sampled from (p + q) / 2; the integrand (p - q) log(p/q) is never
/// negative.
/// @throws InvalidInput as kl_monte_carlo
template <class P, class Q>
DivergenceEstimate symmetric_kl_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q,
                                            RandomStream& stream,
                                            const DivergenceSamplingSettings& settings = {});

/// Integral square distance int (p - q)^2 dX, sampled from (p + q) / 2, in units of 1 / dX.
/// @throws InvalidInput as kl_monte_carlo
template <class P, class Q>
DivergenceEstimate isd_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                                   const DivergenceSamplingSettings& settings = {});

}  // namespace posemix
