// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

/// The inner loop of the trapezoidal rule on SO(3), with the widest vector instructions of the
/// machine.
namespace posemix::internal {

/// Points that are evaluated at once.
inline constexpr std::size_t kTangentPoints = 64;

/// A component as seen from a centre C: scalar part and whitened vector part of the quaternion of
/// X mean^-1 for X = Exp(L x) C are linear in cos(t/2) and sin(t/2) / t times x, with t = |L x|.
struct TangentPeak {
  double scalar[4];
  double white[3][4];
  double log_scale;  ///< log weight - (3 log 2 pi + log det P) / 2
};

struct alignas(64) TangentBlock {
  double x[3][kTangentPoints];     ///< in: whitened coordinates about the centre
  double squared[kTangentPoints];  ///< out: |x|^2
  double mass[kTangentPoints];     ///< out: exp(-|x|^2 / 2)
  double log_p[kTangentPoints];    ///< out: log densities
  double log_q[kTangentPoints];
};

/// The components of p and then those of q as seen from a centre; neither are empty.
struct TangentView {
  double variances[3];  ///< the columns of L are orthogonal, of these squared lengths
  const TangentPeak* peaks;
  std::size_t of_p;
  std::size_t count;
};

/// Evaluates a block, in which t <= pi. `scratch` has 2 * kTangentPoints numbers
/// for every peak.
void tangent_log_densities(const TangentView& view, TangentBlock& block, double* scratch);

}  // namespace posemix::internal
