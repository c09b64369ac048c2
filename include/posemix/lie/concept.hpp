// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <concepts>
#include <limits>

#include <Eigen/Core>

namespace posemix {

/// A matrix Lie group (or R^n) with the charts and Jacobians that densities need.
///
/// Conventions: perturbations act on the left, X = Exp(xi) X0; Exp(xi + d) = Exp(J_l(xi) d) Exp(xi)
/// to first order in d. `Dof` is the dimension of the tangent space, or Eigen::Dynamic if it is
/// known only at run time (`x.dof()`). The congruences take a symmetric matrix and return an
/// exactly symmetric one.
template <typename G>
concept LieGroup = std::copyable<G> &&
    requires(const G& x, const typename G::Tangent& xi, const typename G::TangentMatrix& p,
             const typename G::Scalar& tol) {
  typename G::Scalar;
  requires std::numeric_limits<typename G::Scalar>::is_specialized;
  { G::Dof } -> std::convertible_to<int>;
  requires std::same_as<typename G::Tangent, Eigen::Matrix<typename G::Scalar, G::Dof, 1>>;
  requires std::same_as<typename G::TangentMatrix,
                        Eigen::Matrix<typename G::Scalar, G::Dof, G::Dof>>;
  { G::exp(xi) } -> std::same_as<G>;
  { x.log() } -> std::same_as<typename G::Tangent>;
  { x* x } -> std::same_as<G>;
  { x.inverse() } -> std::same_as<G>;
  { x.identity() } -> std::same_as<G>;
  { x.dof() } -> std::same_as<Eigen::Index>;
  { x.adjoint() } -> std::same_as<typename G::TangentMatrix>;
  { x.adjoint_congruence(p) } -> std::same_as<typename G::TangentMatrix>;
  { x.is_approx(x, tol) } -> std::same_as<bool>;
  { G::ad(xi) } -> std::same_as<typename G::TangentMatrix>;
  { G::left_jacobian(xi) } -> std::same_as<typename G::TangentMatrix>;
  { G::left_jacobian_inverse(xi) } -> std::same_as<typename G::TangentMatrix>;
  { G::right_jacobian(xi) } -> std::same_as<typename G::TangentMatrix>;
  { G::right_jacobian_inverse(xi) } -> std::same_as<typename G::TangentMatrix>;
  { G::left_jacobian_congruence(xi, p) } -> std::same_as<typename G::TangentMatrix>;
  { G::left_jacobian_inverse_congruence(xi, p) } -> std::same_as<typename G::TangentMatrix>;
  { G::log_abs_det_left_jacobian(xi) } -> std::same_as<typename G::Scalar>;
};

/// A Lie group whose elements are square matrices of fixed size.
template <typename G>
concept MatrixLieGroup = LieGroup<G> && requires(const G& x, const typename G::Tangent& xi) {
  { x.matrix() } -> std::same_as<typename G::Matrix>;
  { G::hat(xi) } -> std::same_as<typename G::Matrix>;
  { G::vee(x.matrix()) } -> std::same_as<typename G::Tangent>;
};

}  // namespace posemix
