// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/lie/lie.hpp"

namespace posemix {

/// J_l^-1(xi) by its Bernoulli series up to the fourth power of ad: I - A/2 + A^2/12 - A^4/720. The
/// approximation (error 3e-11 at 0.1 rad, 5e-7 at 0.5 rad, 3e-2 at 3 rad) exists only to reproduce
/// the program of the midway-merge paper; all other code uses left_jacobian_inverse.
template <class G>
typename G::TangentMatrix bernoulli_left_jacobian_inverse(const typename G::Tangent& xi) {
  using Matrix = typename G::TangentMatrix;
  const Matrix a = G::ad(xi);
  const Matrix a2 = a * a;
  return Matrix::Identity(a.rows(), a.cols()) - a / 2 + a2 / 12 - a2 * a2 / 720;
}

/// The congruence J P J^T with J = J_l^-1(xi) by the Bernoulli series. Computed by dense products,
/// because it is not needed where speed matters.
template <class G>
typename G::TangentMatrix bernoulli_inverse_congruence(
    const typename G::Tangent& xi, const typename G::TangentMatrix& covariance) {
  const auto jacobian = bernoulli_left_jacobian_inverse<G>(xi);
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace posemix
