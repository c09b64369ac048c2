// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/density/projected_gaussian.hpp"

/// Operations on projected Gaussians: fusion, composition, inverse, transformation, marginal and
/// conditional densities, splitting.
namespace posemix {

/// The rule by which two projected Gaussians are fused.
enum class FusionRule {
  mode,  ///< at the exact mode of the product, with its Hessian; for any angle
  /// Both are moved to the chart at the rotation halfway (MPG paper, eq. 14-16); for small angles.
  jacobian
};

/// The words of FusionRule in files and options.
template <>
inline constexpr WordTable<FusionRule, 2> words<FusionRule>{{
    {"mode", FusionRule::mode},
    {"jacobian", FusionRule::jacobian},
}};

/// Settings of `fuse` for projected Gaussians.
struct ProjectedFuseSettings {
  FusionRule rule = FusionRule::mode;
  int max_iterations = 100;
  double tolerance = 1e-12;  ///< stop when the norm of the step is below this, or below rounding
  /// FusionRule::jacobian: largest angle between the quaternions of the tangent points, which is
  /// half of the angle between the rotations [rad]. The paper has 15 degrees.
  double max_angle = std::numbers::pi / 12.0;
  /// FusionRule::mode: the product's second mode is returned if its weight relative to the first is
  /// at least this.
  double second_mode_from = 1e-4;
};

/// One mode of a product.
template <RotationOrPose G>
struct ProductMode {
  ProjectedGaussian<G> density;  ///< PG_0 at the mode
  double log_overlap;            ///< log of the product's integral around the mode [nats]
};

/// Result of `fuse`.
template <RotationOrPose G>
struct ProjectedFusion {
  ProjectedGaussian<G> density;  ///< the first mode, PG_0
  double log_overlap;            ///< log of the first mode's integral, over the Haar measure [nats]
  bool converged;
  int iterations;
  /// The second mode of the product, if it has enough weight. It lies between the two densities the
  /// other way round: the quaternions of two rotations can be connected along two arcs.
  std::optional<ProductMode<G>> second;
};

/// The product of two densities (MPG paper, phi, eq. 14) as one projected Gaussian, or two, and the
/// log of its integral.
///
/// FusionRule::mode: Newton's method finds the mode. With v the negative log of the product there
/// and H its Hessian in the chart at the mode, the product is approximately exp(-v - y^T H y / 2).
/// Its integral is C(H^-1) (2 pi)^(n/2) |H|^-1/2 exp(-v), which is Laplace's approximation with
/// exact normalisers. If the iteration does not converge, `converged` is false; nothing is thrown.
/// @throws InvalidInput for settings out of range, and with FusionRule::jacobian when the angle
/// exceeds `max_angle`
template <RotationOrPose G>
ProjectedFusion<G> fuse(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q,
                        const ProjectedFuseSettings& settings = {});

/// Angle between the quaternions of two tangent points, from 0 to pi/2; half of the angle between
/// the rotations [rad].
template <RotationOrPose G>
double tangent_angle(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  return 0.5 * (p.tangent_point().inverse() * q.tangent_point()).angle();
}

/// The rule by which a nonlinear function of projected Gaussians is approximated by a projected
/// Gaussian.
enum class CompositionRule {
  /// Moments of the function under the distributions of its arguments by a cubature rule of degree
  /// five (289 points for two poses, \cite stroud1971), then the projected Gaussian whose
  /// distribution has these moments.
  cubature,
  /// Mean and covariance of the function's coordinates by the 2n points of degree three over the
  /// Gaussians in the tangent spaces; they become mean and covariance of the resulting Gaussian.
  third_degree_cubature,
  jacobian  ///< linearised at the modes (MPG paper, eq. 17)
};

/// The words of CompositionRule in files and options.
template <>
inline constexpr WordTable<CompositionRule, 3> words<CompositionRule>{{
    {"cubature", CompositionRule::cubature},
    {"third_degree_cubature", CompositionRule::third_degree_cubature},
    {"jacobian", CompositionRule::jacobian},
}};

/// The density PG_0 of X Y for independent X and Y (MPG paper, gamma, eq. 17, dq3 = dq2 dq1, where
/// X is 2 and Y is 1).
/// @throws InvalidInput when X and Y are too wide for one projected Gaussian of their product, and
/// where the covariance overflows
template <RotationOrPose G>
ProjectedGaussian<G> compose(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule = CompositionRule::cubature);

/// The density PG_0 of X^-1. Exact on SO(3).
template <RotationOrPose G>
ProjectedGaussian<G> inverse(const ProjectedGaussian<G>& x,
                             CompositionRule rule = CompositionRule::cubature);

/// The density PG_0 of X^-1 Y for independent X and Y.
template <RotationOrPose G>
ProjectedGaussian<G> between(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule = CompositionRule::cubature);

/// The density of A X for a fixed A. Exact.
template <RotationOrPose G>
ProjectedGaussian<G> transform(const G& a, const ProjectedGaussian<G>& x);

/// The density of X B for a fixed B. Exact if B has no translation, otherwise PG_0 by the rule.
template <RotationOrPose G>
ProjectedGaussian<G> transform(const ProjectedGaussian<G>& x, const G& b,
                               CompositionRule rule = CompositionRule::cubature);

/// The marginal density of the rotation. Exact.
ProjectedGaussian<SO3d> rotation_marginal(const ProjectedGaussian<SE3d>& density);

/// Mean and covariance of the translation [m]. Its marginal density is a Gaussian only if the
/// translation is independent of the rotation.
struct TranslationMoments {
  Eigen::Vector3d mean;
  Eigen::Matrix3d covariance;
};
/// The moments of the translation of a pose.
TranslationMoments translation_marginal(const ProjectedGaussian<SE3d>& density);

/// The density of the rotation given the translation [m]. Exact.
ProjectedGaussian<SO3d> rotation_given_translation(const ProjectedGaussian<SE3d>& density,
                                                   const Eigen::Vector3d& translation);

/// The Gaussian of the translation given the rotation. Exact.
/// @throws InvalidInput when the rotation is by pi from the tangent point
TranslationMoments translation_given_rotation(const ProjectedGaussian<SE3d>& density,
                                              const SO3d& rotation);

/// A part of a split density.
template <RotationOrPose G>
struct SplitPiece {
  double weight;
  ProjectedGaussian<G> density;  ///< PG_0
};

/// The density as a sum of narrower ones. A part whose standard deviation of u exceeds `max_spread`
/// along a principal axis of the rotation is replaced by three, until no part does. The weights sum
/// to one. The sum of Gaussians is close to the Gaussian in the tangent space; every part is then
/// moved to the chart at its own mode, which is first order in its own spread.
/// @param max_spread standard deviation of u, about half of that of the rotation in rad
/// @throws InvalidInput when max_spread is not positive, or more than 1000 parts would be needed
template <RotationOrPose G>
std::vector<SplitPiece<G>> split(const ProjectedGaussian<G>& density, double max_spread);

}  // namespace posemix
