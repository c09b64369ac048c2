// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/divergence/so3_quadrature.hpp"

namespace posemix {

/// Divergences by the integration method of the midway-merge paper, and the mass of p on its grid.
struct PaperGridDivergence {
  double kl;    ///< nats
  double isd;   ///< rad^-3
  double mass;  ///< integral of p, which is one if the integration is right
  std::size_t evaluations;
};

/// The integration method of the midway-merge paper (section V, eq. 26-29), to show its error; for
/// reliable numbers use kl() and isd().
///
/// Euler's method over the cube [-pi, pi]^3 of tangent vectors xi at the first mean of p, with
/// `step` [rad] between the grid points (the paper has 0.3 deg; the integrand is smooth, and 3 deg
/// give the same digits for deviations of 5 deg and more). The tangent vector at every other mean
/// is the truncated Baker-Campbell-Hausdorff series of eq. 28 as printed. Two errors follow: the
/// series is wrong far from the first mean, and the cube reaches beyond |xi| = pi, where an exact
/// logarithm would count rotations twice.
/// @throws InvalidInput when the step is not in [0.001, pi]; the smallest has 2.5e11 points
PaperGridDivergence paper_grid_divergence(const RotationDensity& p, const RotationDensity& q,
                                          double step);

}  // namespace posemix
