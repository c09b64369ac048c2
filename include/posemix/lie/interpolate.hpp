// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/concept.hpp"

namespace posemix {

/// The point at parameter `t` of the geodesic from `a` (t = 0) to `b` (t = 1), Exp(t Log(b a^-1))
/// a.
///
/// Evaluated as a Exp(t Log(a^-1 b)), which is the same element and does not lose digits far from
/// the origin. If a^-1 b rotates by exactly pi, both half turns are geodesics, and the choice is
/// that of log().
template <LieGroup G>
G interpolate(const G& a, const G& b, const typename G::Scalar& t) {
  const typename G::Tangent step = t * (a.inverse() * b).log();
  return a * G::exp(step);
}

}  // namespace posemix
