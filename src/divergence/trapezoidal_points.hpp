// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "quadrature_rules.hpp"

/// Points of trapezoidal rules in balls, whose spacing falls by sqrt(2) from level to level. No
/// level contains another: lattices that do share waves that they both mistake for a constant, so
/// that their difference says nothing about these.
namespace posemix::internal {

/// The spacing of a level in standard deviations of the weight.
inline double trapezoidal_spacing(int level) { return 0.8 * std::exp2(0.5 - 0.5 * level); }

/// Calls visit(x, y, z, weight) for the points of a body-centred cubic lattice in a ball, in a
/// fixed order. Of all lattices it resolves most with the same number of points.
template <class Visit>
void visit_lattice(int level, double radius, const Visit& visit) {
  const double h = trapezoidal_spacing(level);
  const double weight = h * h * h;
  // Points have three even or three odd coordinates, in halves of the edge of the cubic cell.
  const double half_edge = 0.5 * std::cbrt(2.0 * weight);
  const double reach = radius / half_edge;
  const int last = static_cast<int>(reach);
  for (int i = -last; i <= last; ++i) {
    for (int j = -last + (last - i) % 2; j <= last; j += 2) {
      const double rest = reach * reach - static_cast<double>(i * i + j * j);
      if (rest < 0.0) continue;
      const int end = static_cast<int>(std::sqrt(rest));
      for (int k = -end + (end - i) % 2; k <= end; k += 2)
        visit(half_edge * i, half_edge * j, half_edge * k, weight);
    }
  }
}

/// The same for functions that are symmetric about the z axis: equal steps in z, and y = 0. Radii
/// up to 127 spacings are possible.
template <class Visit>
void visit_half_plane(int level, double radius, const Visit& visit) {
  const double h = trapezoidal_spacing(level);
  for (const auto& node : DiscRule::instance().nodes) {
    const double x = h * node.at;
    const double rest = radius * radius - x * x;
    if (rest < 0.0) return;
    const int end = static_cast<int>(std::sqrt(rest) / h);
    for (int k = -end; k <= end; ++k) visit(x, 0.0, h * k, h * h * h * node.weight);
  }
}

}  // namespace posemix::internal
