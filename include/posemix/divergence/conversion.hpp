// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/divergence/monte_carlo.hpp"

/// Conversions between concentrated and projected Gaussians, with the divergence that they cost.
/// Compiled for SO3d and SE3d.
namespace posemix {

/// The rule by which a density of one kind is approximated by one of the other.
enum class ConversionRule {
  /// To first order in the perturbation on the right: u = phi / 2 and t = t0 + R0 rho.
  linear,
  /// Moments of the distribution in the coordinates of the other kind, by cubature of degree five,
  /// about the element at which their mean is zero.
  cubature,
  /// The least divergence D(original || converted). The expectations are by Gauss-Hermite
  /// quadrature, the mean by a Newton iteration on the likelihood. Tails that matter (beyond 60
  /// degrees) are cut off at the last node of the quadrature.
  maximum_likelihood
};

/// The words of ConversionRule in files and options.
template <>
inline constexpr WordTable<ConversionRule, 3> words<ConversionRule>{{
    {"maximum_likelihood", ConversionRule::maximum_likelihood},
    {"cubature", ConversionRule::cubature},
    {"linear", ConversionRule::linear},
}};

/// One converted density.
template <class D>
struct ConvertedDensity {
  D density;
  bool converged;  ///< whether the iteration of the mean converged
};

/// The projected Gaussian PG_0 that approximates a concentrated one.
/// @throws InvalidInput where no point of the rule is within 150 deg of the centre: of a density
/// that is far wider than all rotations
template <RotationOrPose G>
ConvertedDensity<ProjectedGaussian<G>> to_projected(
    const ConcentratedGaussian<G>& density,
    ConversionRule rule = ConversionRule::maximum_likelihood);

/// The concentrated Gaussian that approximates a projected one.
/// @throws InvalidInput as to_projected
template <RotationOrPose G>
ConvertedDensity<ConcentratedGaussian<G>> to_concentrated(
    const ProjectedGaussian<G>& density, ConversionRule rule = ConversionRule::maximum_likelihood);

/// The density as a sum of narrower ones, like `split` for projected Gaussians: it is replaced by
/// three along the principal axis of the rotation, until no standard deviation of the rotation
/// vector exceeds `max_spread` [rad]. In the tangent space moments up to the fifth are kept; every
/// part is then back-projected, which is first order.
/// @throws InvalidInput when max_spread is not positive, or more than 1000 parts would be needed
template <RotationOrPose G>
std::vector<Component<ConcentratedGaussian<G>>> split(const ConcentratedGaussian<G>& density,
                                                      double max_spread);

/// The treatment of a component whose conversion would lose more than the limit.
enum class LargeLoss {
  /// Split it more and more finely until the loss meets the limit or `max_pieces` is reached.
  split,
  refuse,  ///< throw InvalidInput
  accept   ///< convert it nevertheless
};

/// The words of LargeLoss in files and options.
template <>
inline constexpr WordTable<LargeLoss, 3> words<LargeLoss>{{
    {"split", LargeLoss::split},
    {"refuse", LargeLoss::refuse},
    {"accept", LargeLoss::accept},
}};

/// Settings for the conversion of mixtures.
struct ConversionSettings {
  ConversionRule rule = ConversionRule::maximum_likelihood;
  /// Limit on the loss of every component [nats]; the mixture then loses no more than that either.
  double max_kl = 0.05;
  LargeLoss on_large_loss = LargeLoss::split;
  std::size_t max_pieces = 81;  ///< largest number of parts of one component
  DivergenceSamplingSettings sampling{.samples = 1 << 13, .replicates = 16};
};

/// A converted mixture.
template <class D>
struct Conversion {
  Mixture<D> mixture;
  /// D(original || converted) of the mixtures [nats]; far below zero where components turn by more
  /// than half a turn, so that their densities do not integrate to one.
  double kl_lost;
  double kl_error;              ///< standard error of `kl_lost` [nats]
  double largest_component_kl;  ///< loss of a single component, the largest in size [nats]
  std::size_t components_split;
  bool converged;     ///< whether every iteration of a mean converged
  bool within_limit;  ///< whether every component's loss is at most the limit, in size
};

/// The mixture of projected Gaussians that approximates one of concentrated ones, component by
/// component; the losses are measured by `kl_monte_carlo`.
/// @throws InvalidInput when max_kl is not positive, max_pieces is zero, and with LargeLoss::refuse
/// when a component loses more than max_kl; as to_projected of a density
template <RotationOrPose G>
Conversion<ProjectedGaussian<G>> to_projected(const Mixture<ConcentratedGaussian<G>>& mixture,
                                              RandomStream& stream,
                                              const ConversionSettings& settings = {});

/// The mixture of concentrated Gaussians that approximates one of projected ones, by the same
/// method.
/// @throws InvalidInput as to_projected
template <RotationOrPose G>
Conversion<ConcentratedGaussian<G>> to_concentrated(const Mixture<ProjectedGaussian<G>>& mixture,
                                                    RandomStream& stream,
                                                    const ConversionSettings& settings = {});

}  // namespace posemix
