// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <ostream>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/mixture/mixture.hpp"
#include "posemix/testing/lie_draw.hpp"

/// Random densities and mixture components for property tests, on any group. Call them inside a
/// RapidCheck property.
namespace posemix {

/// Prints a component of a counterexample for RapidCheck.
template <LieGroup G>
void showValue(const Component<ConcentratedGaussian<G>>& component, std::ostream& stream) {
  stream << "weight " << std::exp(component.log_weight) << ", log mean "
         << component.density.mean().log().transpose() << ", covariance\n"
         << component.density.covariance() << '\n';
}

namespace testing {

/// Runs the property inside the current Google test and fails it with the counterexample.
/// It is not a template, so that RapidCheck's machinery is compiled once, not for every property.
#ifdef POSEMIX_TESTING_COMPILED
void check_property(const std::function<void()>& property);
#else
inline void check_property(const std::function<void()>& property) {
  rc::detail::checkGTest(property);
}
#endif

/// Number of tangent coordinates used for a group: three poses for a stack.
template <LieGroup G>
constexpr Eigen::Index tested_dof() {
  return G::Dof == Eigen::Dynamic ? 18 : G::Dof;
}

/// An element whose tangent coordinates all lie within `reach` (rad, m).
template <LieGroup G>
G draw_near_identity(double reach) {
  return G::exp(draw_vector<double, G::Dof>(tested_dof<G>(), reach));
}

/// A correlated covariance; `deviation` is its root mean square standard deviation, roughly.
template <LieGroup G>
typename G::TangentMatrix draw_spread(double deviation) {
  const Eigen::Index n = tested_dof<G>();
  const double variance = deviation * deviation / (2.0 + static_cast<double>(n) / 3.0);
  return variance * draw_covariance<G>(n);
}

template <LieGroup G>
ConcentratedGaussian<G> draw_gaussian(double reach, double deviation) {
  return ConcentratedGaussian<G>(draw_near_identity<G>(reach), draw_spread<G>(deviation));
}

template <LieGroup G>
using Components = std::vector<Component<ConcentratedGaussian<G>>>;

/// `count` components around an element within 1 of the identity, their means within `reach` of it,
/// with weights between 0.001 and 1, not normalised.
template <LieGroup G>
Components<G> draw_components(std::size_t count, double reach, double deviation) {
  const G centre = draw_near_identity<G>(1.0);
  Components<G> components;
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = 1e-3 * draw_integer(1, 1001);
    const G mean = draw_near_identity<G>(reach) * centre;
    components.push_back(
        {std::log(weight), ConcentratedGaussian<G>(mean, draw_spread<G>(deviation))});
  }
  return components;
}

#ifdef POSEMIX_TESTING_COMPILED
// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_DENSITY_DRAW(prefix, G)                                     \
  prefix template G draw_near_identity<G>(double);                          \
  prefix template typename G::TangentMatrix draw_spread<G>(double);         \
  prefix template ConcentratedGaussian<G> draw_gaussian<G>(double, double); \
  prefix template Components<G> draw_components<G>(std::size_t, double, double)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_DENSITY_DRAW(extern, SO3d);
POSEMIX_DENSITY_DRAW(extern, SE3d);
POSEMIX_DENSITY_DRAW(extern, PoseStackd);
POSEMIX_DENSITY_DRAW(extern, Rnd<3>);
#endif

}  // namespace testing

#ifdef POSEMIX_TESTING_COMPILED
// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_SHOW_COMPONENT(prefix, G) \
  prefix template void showValue(const Component<ConcentratedGaussian<G>>&, std::ostream&)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_SHOW_COMPONENT(extern, SO3d);
POSEMIX_SHOW_COMPONENT(extern, SE3d);
POSEMIX_SHOW_COMPONENT(extern, PoseStackd);
POSEMIX_SHOW_COMPONENT(extern, Rnd<3>);
#endif

}  // namespace posemix
