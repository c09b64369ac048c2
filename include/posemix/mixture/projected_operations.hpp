// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <limits>

#include "posemix/base/words.hpp"
#include "posemix/density/projected_operations.hpp"
#include "posemix/mixture/operations.hpp"

/// Operations on mixtures of projected Gaussians, MPG (MPG paper, III-D).
namespace posemix {

/// The rule for the weight of a pair of components in the fusion of two mixtures.
enum class PairWeight {
  overlap,  ///< the integral of the product of the two densities
  /// alpha delta of the MPG paper, eq. 19: alpha is one if the tangent points are close enough for
  /// the Jacobian rule, otherwise zero, and delta = exp(-d^T (P1 + P2)^-1 d / 2) for the difference
  /// d of the means in the common tangent space. Not a probability: determinants and normalisers
  /// are missing.
  alpha_delta
};

/// The words of PairWeight in files and options.
template <>
inline constexpr WordTable<PairWeight, 2> words<PairWeight>{{
    {"overlap", PairWeight::overlap},
    {"alpha_delta", PairWeight::alpha_delta},
}};

/// Settings of `fuse` for mixtures of projected Gaussians.
struct ProjectedMixtureFuseSettings {
  /// With FusionRule::jacobian, pairs of tangent points further apart than its limit get no weight.
  ProjectedFuseSettings pair{};
  PairWeight weight = PairWeight::overlap;
};

/// The normalised product of two mixtures (MPG paper, Phi, eq. 19-20, whose weights lack
/// determinants and normalisers) and the log of its integral over the group. With
/// PairWeight::alpha_delta, the log of the sum in eq. 20 takes the place of the integral. A pair
/// whose product has two modes gives two components.
/// @throws InvalidInput for settings out of range, and when no pair has any weight
template <RotationOrPose G>
MixtureFusion<ProjectedGaussian<G>> fuse(const Mixture<ProjectedGaussian<G>>& p,
                                         const Mixture<ProjectedGaussian<G>>& q,
                                         const ProjectedMixtureFuseSettings& settings = {});

/// Settings of `compose`, `between` and `inverse` for mixtures of projected Gaussians.
struct ProjectedMixtureComposeSettings {
  CompositionRule rule = CompositionRule::cubature;
  /// The factor on the left is split first if its rotation is wider than this: standard deviation
  /// along any axis [rad]. The product of a wide factor and a long translation is not close to one
  /// projected Gaussian. Infinite: never split.
  double split_above = std::numeric_limits<double>::infinity();
};

/// The mixture of X Y for independent X and Y (MPG paper, Gamma, eq. 21-22).
/// @throws InvalidInput when split_above is not positive, or too many parts would be needed
template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> compose(const Mixture<ProjectedGaussian<G>>& x,
                                      const Mixture<ProjectedGaussian<G>>& y,
                                      const ProjectedMixtureComposeSettings& settings = {});

/// The mixture of X^-1.
template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> inverse(const Mixture<ProjectedGaussian<G>>& x,
                                      const ProjectedMixtureComposeSettings& settings = {});

/// The mixture of X^-1 Y for independent X and Y.
template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> between(const Mixture<ProjectedGaussian<G>>& x,
                                      const Mixture<ProjectedGaussian<G>>& y,
                                      const ProjectedMixtureComposeSettings& settings = {});

/// The mixture of A X for a fixed A. Exact.
template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> transform(const G& a, const Mixture<ProjectedGaussian<G>>& x);

/// The mixture of X B for a fixed B.
template <RotationOrPose G>
Mixture<ProjectedGaussian<G>> transform(const Mixture<ProjectedGaussian<G>>& x, const G& b,
                                        const ProjectedMixtureComposeSettings& settings = {});

extern template class Mixture<ProjectedGaussian<SO3d>>;
extern template class Mixture<ProjectedGaussian<SE3d>>;

}  // namespace posemix
