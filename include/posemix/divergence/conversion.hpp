// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"
#include "posemix/divergence/monte_carlo.hpp"

/// Projected Gaussians from concentrated ones and back, with the divergence that it costs. Compiled
/// for SO3d and SE3d.
namespace posemix {

/// How one density of one kind stands for one of the other.
enum class ConversionRule {
  /// To first order in the perturbation on the right, u = phi / 2 and t = t0 + R0 rho.
  linear,
  /// The moments of the distribution in the other kind's coordinates by cubature of degree five,
  /// about the
  /// element where their mean is zero.
  cubature,
  /// The least divergence D(original || converted): the expectations by Gauss-Hermite quadrature,
  /// the mean by a Newton iteration on the likelihood. Where the tails matter (beyond 60 degrees)
  /// they are cut off at the quadrature's last node.
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
  bool converged;  ///< of the iterated mean
};

/// A projected Gaussian, PG_0, for a concentrated one.
template <RotationOrPose G>
ConvertedDensity<ProjectedGaussian<G>> to_projected(
    const ConcentratedGaussian<G>& density,
    ConversionRule rule = ConversionRule::maximum_likelihood);

/// A concentrated Gaussian for a projected one.
template <RotationOrPose G>
ConvertedDensity<ConcentratedGaussian<G>> to_concentrated(
    const ProjectedGaussian<G>& density, ConversionRule rule = ConversionRule::maximum_likelihood);

/// The density as a sum of narrower ones, as `split` for projected Gaussians: three in place of one
/// along the principal axis of the rotation, again and again until no standard deviation of the
/// rotation vector exceeds `max_spread` [rad]; in the tangent space moments up to the fifth are
/// kept, every piece is then back-projected, which is first order.
/// @throws InvalidInput when max_spread is not positive, or needs more than 1000 pieces
template <RotationOrPose G>
std::vector<Component<ConcentratedGaussian<G>>> split(const ConcentratedGaussian<G>& density,
                                                      double max_spread);

/// What happens to a component that would lose more than the limit.
enum class LargeLoss {
  split,   ///< it is split, more and more finely, until its loss meets the limit
  refuse,  ///< InvalidInput
  accept
};

/// The words of LargeLoss in files and options.
template <>
inline constexpr WordTable<LargeLoss, 3> words<LargeLoss>{{
    {"split", LargeLoss::split},
    {"refuse", LargeLoss::refuse},
    {"accept", LargeLoss::accept},
}};

/// Settings of the conversion of mixtures.
struct ConversionSettings {
  ConversionRule rule = ConversionRule::maximum_likelihood;
  double max_kl = 0.05;  ///< of a component [nats]; so that of the mixture loses no more
  LargeLoss on_large_loss = LargeLoss::split;
  std::size_t max_pieces = 81;  ///< of a component
  DivergenceSamplingSettings sampling{.samples = 1 << 13, .replicates = 16};
};

/// A converted mixture.
template <class D>
struct Conversion {
  Mixture<D> mixture;
  double kl_lost;               ///< D(original || converted) of the mixtures [nats]
  double kl_error;              ///< its standard error
  double largest_component_kl;  ///< the largest of the components' own [nats]
  std::size_t components_split;
  bool converged;     ///< of every iterated mean
  bool within_limit;  ///< whether every component's loss meets the limit
};

/// A mixture of projected Gaussians for one of concentrated ones, component by component; losses
/// are measured by `kl_monte_carlo`.
/// @throws InvalidInput when max_kl is not positive, max_pieces is zero, and with LargeLoss::refuse
/// when a component loses more than max_kl
template <RotationOrPose G>
Conversion<ProjectedGaussian<G>> to_projected(const Mixture<ConcentratedGaussian<G>>& mixture,
                                              RandomStream& stream,
                                              const ConversionSettings& settings = {});

/// A mixture of concentrated Gaussians for one of projected ones. As to_projected.
template <RotationOrPose G>
Conversion<ConcentratedGaussian<G>> to_concentrated(const Mixture<ProjectedGaussian<G>>& mixture,
                                                    RandomStream& stream,
                                                    const ConversionSettings& settings = {});

}  // namespace posemix
