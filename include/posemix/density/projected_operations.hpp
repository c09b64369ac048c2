// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "posemix/base/words.hpp"
#include "posemix/density/projected_gaussian.hpp"

/// Operations on projected Gaussians: fuse, compose, invert, move, take parts.
namespace posemix {

/// How two projected Gaussians are fused.
enum class FusionRule {
  mode,     ///< at the exact mode of the product, with its Hessian; any angle
  jacobian  ///< both moved to the chart at the rotation halfway (MPG paper, eq. 14-16); small
            ///< angles only
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
  double tolerance = 1e-12;  ///< stop when the step's norm falls below this, or rounding
  /// FusionRule::jacobian: largest angle between the quaternions of the tangent points, which is
  /// half of that between the rotations [rad]. The paper's is 15 degrees.
  double max_angle = std::numbers::pi / 12.0;
  /// FusionRule::mode: the product's second mode is returned where its weight relative to the first
  /// is at least this.
  double second_mode_from = 1e-4;
};

/// One mode of a product.
template <RotationOrPose G>
struct ProductMode {
  ProjectedGaussian<G> density;  ///< PG_0 at the mode
  double log_overlap;  ///< log of the integral of the product around it over the group [nats]
};

/// Result of `fuse`.
template <RotationOrPose G>
struct ProjectedFusion {
  ProjectedGaussian<G> density;  ///< the first mode, PG_0
  double log_overlap;            ///< log of its integral with respect to the Haar measure [nats]
  bool converged;
  int iterations;
  /// Seen from either density the other lies beyond its equator too, so the product has a mode on
  /// either way round.
  std::optional<ProductMode<G>> second;
};

/// The product of two densities (MPG paper, phi, eq. 14) as one projected Gaussian, or two, and the
/// log of its integral.
///
/// FusionRule::mode: Newton's method finds the mode; with v the negative log of the product there
/// and H its Hessian in the chart at the mode, the product is about exp(-v - y^T H y / 2), whose
/// integral C(H^-1) (2 pi)^(n/2) |H|^-1/2 is that of a projected Gaussian: Laplace's approximation
/// with the normalisers exact. Not converging is reported, not thrown.
/// @throws InvalidInput for settings out of range, and with FusionRule::jacobian when the angle
/// exceeds `max_angle`
template <RotationOrPose G>
ProjectedFusion<G> fuse(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q,
                        const ProjectedFuseSettings& settings = {});

/// Angle between the quaternions of two tangent points, 0 to pi/2; half of the angle between the
/// rotations [rad].
template <RotationOrPose G>
double tangent_angle(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  return 0.5 * (p.tangent_point().inverse() * q.tangent_point()).angle();
}

/// How a nonlinear function of projected Gaussians becomes one.
enum class CompositionRule {
  /// Its moments under the densities' distributions by a cubature rule of degree five (for two
  /// poses 289
  /// points \cite stroud1971), then the projected Gaussian whose distribution has them.
  cubature,
  /// Mean and covariance of its coordinates by the 2n points of degree three over the Gaussians in
  /// the tangent spaces, taken for those of the result.
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

/// The density of X Y for independent X and Y (MPG paper, gamma, eq. 17, dq3 = dq2 dq1 with X = 2,
/// Y = 1), PG_0.
template <RotationOrPose G>
ProjectedGaussian<G> compose(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule = CompositionRule::cubature);

/// The density of X^-1, PG_0. On SO(3) exact.
template <RotationOrPose G>
ProjectedGaussian<G> inverse(const ProjectedGaussian<G>& x,
                             CompositionRule rule = CompositionRule::cubature);

/// The density of X^-1 Y for independent X and Y, PG_0.
template <RotationOrPose G>
ProjectedGaussian<G> between(const ProjectedGaussian<G>& x, const ProjectedGaussian<G>& y,
                             CompositionRule rule = CompositionRule::cubature);

/// The density of A X for a fixed A. Exact.
template <RotationOrPose G>
ProjectedGaussian<G> transform(const G& a, const ProjectedGaussian<G>& x);

/// The density of X B for a fixed B: exact where B has no translation, else PG_0 by the rule.
template <RotationOrPose G>
ProjectedGaussian<G> transform(const ProjectedGaussian<G>& x, const G& b,
                               CompositionRule rule = CompositionRule::cubature);

/// The density of the rotation. Exact.
ProjectedGaussian<SO3d> rotation_marginal(const ProjectedGaussian<SE3d>& density);

/// Mean and covariance of the translation [m]; its density is Gaussian where it is independent of
/// the rotation.
struct TranslationMoments {
  Eigen::Vector3d mean;
  Eigen::Matrix3d covariance;
};
TranslationMoments translation_marginal(const ProjectedGaussian<SE3d>& density);

/// The rotation given the translation [m]. Exact.
ProjectedGaussian<SO3d> rotation_given_translation(const ProjectedGaussian<SE3d>& density,
                                                   const Eigen::Vector3d& translation);

/// The translation given the rotation: Gaussian, exact.
/// @throws InvalidInput when the rotation is by pi from the tangent point
TranslationMoments translation_given_rotation(const ProjectedGaussian<SE3d>& density,
                                              const SO3d& rotation);

/// A piece of a split density.
template <RotationOrPose G>
struct SplitPiece {
  double weight;
  ProjectedGaussian<G> density;  ///< PG_0
};

/// The density as a sum of narrower ones: along every principal axis of the rotation whose standard
/// deviation of u exceeds `max_spread`, three Gaussians in place of one, again and again until none
/// does. The weights sum to one. Sums of Gaussians are close to the Gaussian in the tangent space;
/// every piece is then moved to the chart at its own mode, which is first order in its own spread.
/// @param max_spread standard deviation of u, about half of that of the rotation in rad
/// @throws InvalidInput when max_spread is not positive, or needs more than 1000 pieces
template <RotationOrPose G>
std::vector<SplitPiece<G>> split(const ProjectedGaussian<G>& density, double max_spread);

}  // namespace posemix
