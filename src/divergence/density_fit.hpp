// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/divergence/conversion.hpp"
#include "quadrature_points.hpp"

namespace posemix::internal {

/// The concentrated Gaussian with the mean and the covariance of the points or, with `most_likely`,
/// the one of largest likelihood.
template <RotationOrPose G>
ConvertedDensity<ConcentratedGaussian<G>> fit_concentrated(const QuadraturePoints<G>& points,
                                                           bool most_likely);

/// The projected Gaussian PG_0 whose distribution has the moments of the points in the chart in
/// which the mean of u is zero or, with `most_likely`, the one of largest likelihood.
template <RotationOrPose G>
ConvertedDensity<ProjectedGaussian<G>> fit_projected(const QuadraturePoints<G>& points,
                                                     bool most_likely);

}  // namespace posemix::internal
