// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/density/projected_gaussian.hpp"
#include "posemix/mixture/mixture.hpp"

/// Divergences between two projected Gaussians in closed form. Both are moved to one chart, in the
/// tangent space at the rotation halfway between their modes, which is first order in u; densities
/// with one tangent point are not changed.
///
/// In theory, two distributions with different equators have an infinite Kullback-Leibler
/// divergence, because one vanishes where the other does not. In one chart both have the same
/// equator, so the mass near it is left out.
///
/// Compiled for SO3d and SE3d.
namespace posemix {

/// D(p || q) of the two Gaussians in the tangent space [nats].
template <RotationOrPose G>
double gaussian_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q);

/// D(p || q) + D(q || p) of the two Gaussians in the tangent space [nats] (MPG paper, eq. 23).
template <RotationOrPose G>
double gaussian_symmetric_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q);

/// D(p || q) of the two distributions [nats], with the exact moments and normalisers of both in the
/// common chart; exact for densities with one tangent point.
template <RotationOrPose G>
double exact_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q);

/// D(p || q) + D(q || p) of the two distributions [nats].
template <RotationOrPose G>
double exact_symmetric_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q);

/// Runnalls' bound as for concentrated Gaussians, in the chart at the weighted mean of the two
/// modes' rotations.
template <RotationOrPose G>
double runnalls_bound(const Component<ProjectedGaussian<G>>& a,
                      const Component<ProjectedGaussian<G>>& b);

/// The Mahalanobis distance sqrt(d^T (P_a + P_b)^-1 d) for the difference d of the means in the
/// common chart.
template <RotationOrPose G>
double mahalanobis_distance(const ProjectedGaussian<G>& a, const ProjectedGaussian<G>& b);

}  // namespace posemix
