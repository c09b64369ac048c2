// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstddef>
#include <ostream>
#include <utility>
#include <vector>

#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/mixture/mixture.hpp"
#include "posemix/testing/lie_draw.hpp"

/// Random densities and mixture components for property tests, on any group. Call them inside a
/// RapidCheck property.
namespace posemix {

/// How RapidCheck prints a component of a counterexample.
template <LieGroup G>
void showValue(const Component<ConcentratedGaussian<G>>& component, std::ostream& stream) {
  stream << "weight " << std::exp(component.log_weight) << ", log mean "
         << component.density.mean().log().transpose() << ", covariance\n"
         << component.density.covariance() << '\n';
}

namespace testing {

/// Runs the property inside the current Google test and fails it with the counterexample.
template <class Property>
void check_property(Property&& property) {
  rc::detail::checkGTest(std::forward<Property>(property));
}

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

/// `count` components around an element within 1 of the identity, their means within `reach` of it,
/// with weights between 0.001 and 1, not normalised.
template <LieGroup G>
std::vector<Component<ConcentratedGaussian<G>>> draw_components(std::size_t count, double reach,
                                                                double deviation) {
  const G centre = draw_near_identity<G>(1.0);
  std::vector<Component<ConcentratedGaussian<G>>> components;
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = 1e-3 * *rc::gen::inRange(1, 1001);
    const G mean = draw_near_identity<G>(reach) * centre;
    components.push_back(
        {std::log(weight), ConcentratedGaussian<G>(mean, draw_spread<G>(deviation))});
  }
  return components;
}

}  // namespace testing
}  // namespace posemix
