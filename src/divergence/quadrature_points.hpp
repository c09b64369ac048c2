// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <numbers>
#include <vector>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/density/projected_gaussian.hpp"

namespace posemix::internal {

/// Weighted elements that approximate a density; the weights sum to one.
template <RotationOrPose G>
struct QuadraturePoints {
  std::vector<G> elements;
  std::vector<double> weights;
};

/// The rule for the points of a density.
enum class PointRule {
  cubature,   ///< 13 rotations, exact for polynomials of degree five
  quadrature  ///< the product of three Gauss-Hermite rules of eleven nodes
};

/// The angle from the centre of a Gaussian in a tangent space beyond which points are left out
/// [rad], because there the coordinates of a projected Gaussian grow without limit.
inline constexpr double kReach = 150.0 * std::numbers::pi / 180.0;

/// The quadrature points of a density within kReach. For a pose, every rotation is combined with
/// six translations that have the mean and the covariance of the translation given the rotation.
/// @throws InvalidInput where none is within kReach
template <RotationOrPose G>
QuadraturePoints<G> quadrature_points(const TangentGaussian<G>& density, PointRule rule);
template <RotationOrPose G>
QuadraturePoints<G> quadrature_points(const ProjectedGaussian<G>& density, PointRule rule);

}  // namespace posemix::internal
