// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <Eigen/Core>

#include "posemix/testing/lie_check.hpp"

namespace posemix::testing {

/// Jacobian at zero of a map f from a tangent space of `dof` coordinates into a group: the
/// derivative of Log(f(xi) f(0)^-1), by the five-point rule, to about 1e-11.
template <LieGroup G, class Map>
Eigen::MatrixXd numeric_jacobian(Eigen::Index dof, const Map& f) {
  using Tangent = typename G::Tangent;
  const G origin_inverse = f(Tangent(Tangent::Zero(dof))).inverse();
  Eigen::MatrixXd jacobian(dof, dof);
  for (Eigen::Index i = 0; i < dof; ++i) {
    const Tangent direction = Tangent::Unit(dof, i);
    jacobian.col(i) = derivative_at_zero<double>([&](double s) -> Eigen::VectorXd {
      return (f(Tangent(s * direction)) * origin_inverse).log();
    });
  }
  return jacobian;
}

}  // namespace posemix::testing
