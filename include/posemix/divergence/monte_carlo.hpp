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
/// carry no mass, as in the quadrature on SO(3); points of projected Gaussians are drawn from the
/// Gaussian in the tangent space and weighted by what turns it into the distribution.
///
/// Compiled for concentrated Gaussians on SO3d, SE3d, PoseStackd and Rnd<Eigen::Dynamic>, for
/// projected Gaussians on SO3d and SE3d, and there for one kind against the other.
namespace posemix {

/// How many points.
struct DivergenceSamplingSettings {
  /// In all; every component gets its share in every replicate, and at least 16 points while there
  /// are as many for every component, else at least one.
  std::size_t samples = 1 << 16;
  std::size_t replicates = 32;  ///< independent randomisations, at least 2
};

/// Kullback-Leibler divergence D(p || q) [nats], sampled from p; between projected Gaussians, which
/// integrate to one, from (p + q) / 2 as int (p log(p/q) - p + q), which is never negative.
/// @throws InvalidInput when sizes differ, there are less than 2 replicates, or fewer samples than
/// replicates
template <class P, class Q>
DivergenceEstimate kl_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                                  const DivergenceSamplingSettings& settings = {});

/// D(p || q) + D(q || p) [nats], sampled from (p + q) / 2: (p - q) log(p/q) is never negative.
/// @throws InvalidInput as kl_monte_carlo
template <class P, class Q>
DivergenceEstimate symmetric_kl_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q,
                                            RandomStream& stream,
                                            const DivergenceSamplingSettings& settings = {});

/// Integral square distance int (p - q)^2 dX, sampled from (p + q) / 2; its unit is that of 1 / dX.
/// @throws InvalidInput as kl_monte_carlo
template <class P, class Q>
DivergenceEstimate isd_monte_carlo(const Mixture<P>& p, const Mixture<Q>& q, RandomStream& stream,
                                   const DivergenceSamplingSettings& settings = {});

}  // namespace posemix
