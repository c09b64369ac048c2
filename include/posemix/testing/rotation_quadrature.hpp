// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <boost/math/quadrature/gauss.hpp>

#include "posemix/lie/lie.hpp"

/// Integrals over SO(3) with respect to the Haar measure dX = |det J_l(xi)| dxi, for tests.
namespace posemix::testing {

/// One node of a rule on an interval.
struct QuadratureNode {
  double at;
  double weight;
};

/// Composite Gauss-Legendre rule with 30 points on each of `panels` equal parts of [from, to].
inline std::vector<QuadratureNode> gauss_legendre(double from, double to, int panels) {
  using Rule = boost::math::quadrature::gauss<double, 30>;
  std::vector<QuadratureNode> nodes;
  const double half = 0.5 * (to - from) / panels;
  for (int panel = 0; panel < panels; ++panel) {
    const double centre = from + (2 * panel + 1) * half;
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
      const double offset = half * Rule::abscissa()[i];
      const double weight = half * Rule::weights()[i];
      nodes.push_back({centre - offset, weight});
      nodes.push_back({centre + offset, weight});
    }
  }
  return nodes;
}

/// A product rule on the ball |xi| <= radius in the tangent space: Gauss-Legendre along the radius
/// and in the cosine of the polar angle, trapezoid in the azimuth about `axis`. The volume factor
/// |det J_l| = 2 (1 - cos r) / r^2 is part of the weights. With one azimuth the rule integrates
/// functions that are symmetric about `axis`.
struct BallRule {
  double radius = std::numbers::pi;
  int radial_panels = 2;
  int polar_panels = 2;
  int azimuths = 120;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  /// Calls f(X, weight) at every node X = Exp(xi) centre.
  template <class Function>
  void for_each(const SO3d& centre, Function&& f) const {
    const auto radii = gauss_legendre(0.0, radius, radial_panels);
    const auto cosines = gauss_legendre(-1.0, 1.0, polar_panels);
    const Eigen::Vector3d along = axis.normalized();
    const Eigen::Vector3d across = along.unitOrthogonal();
    const double step = 2.0 * std::numbers::pi / azimuths;
    for (int k = 0; k < azimuths; ++k) {
      const Eigen::Vector3d side =
          std::cos(k * step) * across + std::sin(k * step) * along.cross(across);
      for (const QuadratureNode& c : cosines) {
        const Eigen::Vector3d direction = c.at * along + std::sqrt(1.0 - c.at * c.at) * side;
        for (const QuadratureNode& r : radii) {
          const double volume = 2.0 * (1.0 - std::cos(r.at));
          f(SO3d::exp(r.at * direction) * centre, step * c.weight * r.weight * volume);
        }
      }
    }
  }

  /// The integral of f(X) over X = Exp(xi) centre.
  template <class Function>
  double integrate(const SO3d& centre, Function&& f) const {
    double sum = 0.0;
    for_each(centre, [&](const SO3d& x, double weight) { sum += weight * f(x); });
    return sum;
  }
};

}  // namespace posemix::testing
