// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

/// The inner loop of the quadrature on SO(3), with the widest vector instructions of the machine.
namespace posemix::internal {

/// Points of a ray that are evaluated at once; a Kronrod rule has one fewer.
inline constexpr std::size_t kRayPoints = 16;

/// A component as seen along a ray: the quaternion of X(r) mean^-1 is cos(r/2) A + sin(r/2) B.
struct RayPeak {
  double a_scalar, b_scalar;
  double white_a[3], white_b[3];  ///< vector parts, whitened
  double log_scale;               ///< log weight - (3 log 2 pi + log det P) / 2
};

struct alignas(64) RayBlock {
  double rho[kRayPoints];    ///< in: distances from the centre in standard deviations
  double mass[kRayPoints];   ///< out: rho^2 exp(-rho^2 / 2)
  double log_p[kRayPoints];  ///< out: log densities
  double log_q[kRayPoints];
};

/// Evaluates a block at the angles rho * stretch, in [0, pi]. The first `of_p` of `count` peaks are
/// those of p, the others those of q; neither is empty. `scratch` has 2 * kRayPoints numbers for
/// every peak.
void ray_log_densities(const RayPeak* peaks, std::size_t of_p, std::size_t count, double stretch,
                       RayBlock& block, double* scratch);

}  // namespace posemix::internal
