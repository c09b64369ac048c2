// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/moments.hpp"

/// Moments of mixtures of projected Gaussians. Compiled for SO3d and SE3d.
namespace posemix {

/// The rotation in whose chart the weighted mean of the given rotations is zero, sum_i w_i u_i = 0.
/// It maximises sum_i w_i log cos(theta_i / 2). Found by Newton's method: moving the tangent point
/// by d moves u by -(I + u u^T) d + u x d. The weights sum to one. If the iteration does not
/// converge, `converged` is false; nothing is thrown.
MeanResult<SO3d> gnomonic_mean(std::span<const SO3d> rotations, std::span<const double> weights,
                               const MeanSettings& settings = {});

/// Mean and covariance of y = [u; t] of a weighted sum of components in the chart at a rotation.
/// They are moments of the Gaussians in the tangent space, every component being moved to that
/// chart first (first order in its own u). The weights need not be normalised; components without
/// weight are ignored.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, all weights are
/// zero, or a mode lies by pi from `tangent_point`
template <RotationOrPose G>
ProjectedGaussian<G> tangent_moments(std::span<const Component<ProjectedGaussian<G>>> components,
                                     const SO3d& tangent_point);

/// The projected Gaussian PG_0 whose distribution has the moments of a weighted sum of components.
/// Its tangent point is the rotation at which E[u] = 0 under the distributions; its covariance
/// gives the distribution the second moments there, which is the maximum likelihood for this
/// tangent point. The expectations are by cubature of degree five over the distribution of every
/// component's u, with t given u exact. The weights need not be normalised. If the iteration does
/// not converge, `converged` is false; nothing is thrown. `residual` is |E[u]|.
/// @throws InvalidInput when there is no component, a log-weight is NaN or +inf, or all weights are
/// zero
template <RotationOrPose G>
Moments<ProjectedGaussian<G>> moments(std::span<const Component<ProjectedGaussian<G>>> components,
                                      const MomentSettings& settings = {});

/// Mean and covariance of a whole mixture.
template <RotationOrPose G>
Moments<ProjectedGaussian<G>> moments(const Mixture<ProjectedGaussian<G>>& mixture,
                                      const MomentSettings& settings = {}) {
  return moments<G>(std::span<const Component<ProjectedGaussian<G>>>(mixture.components()),
                    settings);
}

}  // namespace posemix
