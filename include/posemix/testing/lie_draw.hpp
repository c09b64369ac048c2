// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <rapidcheck.h>
#include <Eigen/Core>

#include "posemix/lie/lie.hpp"

/// Random tangent vectors and group elements for property tests. Call them inside a RapidCheck
/// property: they draw integers, so that a failing case shrinks to zeros and round numbers.
namespace posemix::testing {

/// An integer in [lowest, end).
#ifdef POSEMIX_TESTING_COMPILED
int draw_integer(int lowest, int end);
#else
inline int draw_integer(int lowest, int end) { return *rc::gen::inRange(lowest, end); }
#endif

/// A number in [0, 1] with six decimals.
template <typename Scalar>
Scalar draw_fraction() {
  constexpr int kSteps = 1'000'000;
  return Scalar(draw_integer(0, kSteps + 1)) / Scalar(kSteps);
}

/// 10^-k with k in [1, largest].
template <typename Scalar>
Scalar draw_power_of_ten(int largest) {
  using std::pow;
  return pow(Scalar(10), Scalar(-draw_integer(1, largest + 1)));
}

/// An angle in [0, pi) rad: zero, tiny (also with a square that underflows), just below pi, or
/// uniform.
template <typename Scalar>
Scalar draw_angle() {
  const auto pi = static_cast<Scalar>(std::numbers::pi_v<long double>);
  switch (draw_integer(0, 6)) {
    case 0:
      return Scalar(0);
    case 1:
      return draw_power_of_ten<Scalar>(std::min(200, std::numeric_limits<Scalar>::max_exponent10));
    case 2:
      return pi - draw_power_of_ten<Scalar>(std::numeric_limits<Scalar>::digits10 / 2 + 1);
    default:
      return Scalar(0.999) * pi * draw_fraction<Scalar>();
  }
}

/// A vector with entries between -`largest` and `largest`, in steps of a thousandth.
template <typename Scalar, int N>
Eigen::Matrix<Scalar, N, 1> draw_vector(Eigen::Index size, const Scalar& largest) {
  constexpr int kSteps = 1000;
  Eigen::Matrix<Scalar, N, 1> v(size);
  for (Scalar& x : v) x = largest * Scalar(draw_integer(-kSteps, kSteps + 1)) / Scalar(kSteps);
  return v;
}

/// A rotation vector (rad).
template <typename Scalar>
Eigen::Matrix<Scalar, 3, 1> draw_rotation_vector() {
  Eigen::Matrix<Scalar, 3, 1> axis = draw_vector<Scalar, 3>(3, Scalar(1));
  if (axis.isZero(Scalar(0))) axis.x() = Scalar(1);
  return draw_angle<Scalar>() * axis.normalized();
}

/// A translation (m): a millimetre to a hundred metres.
template <typename Scalar>
Eigen::Matrix<Scalar, 3, 1> draw_translation() {
  constexpr std::array kSizes{1.0, 1e-3, 1e2};
  const std::size_t i = *rc::gen::inRange<std::size_t>(0, kSizes.size());
  return draw_vector<Scalar, 3>(3, Scalar(kSizes[i]));
}

/// Draws a tangent vector of a group; specialise it for a group of your own.
template <typename G>
struct TangentDraw;

template <typename S>
struct TangentDraw<SO3<S>> {
  static typename SO3<S>::Tangent draw(Eigen::Index) { return draw_rotation_vector<S>(); }
};

template <typename S>
struct TangentDraw<SE3<S>> {
  static typename SE3<S>::Tangent draw(Eigen::Index) {
    typename SE3<S>::Tangent xi;
    xi << draw_rotation_vector<S>(), draw_translation<S>();
    return xi;
  }
};

template <typename S>
struct TangentDraw<PoseStack<S>> {
  static typename PoseStack<S>::Tangent draw(Eigen::Index dof) {
    typename PoseStack<S>::Tangent xi(dof);
    for (Eigen::Index i = 0; i < dof; i += 6) {
      xi.template segment<6>(i) = TangentDraw<SE3<S>>::draw(6);
    }
    return xi;
  }
};

template <int N, typename S>
struct TangentDraw<Rn<N, S>> {
  static typename Rn<N, S>::Tangent draw(Eigen::Index dof) {
    return draw_vector<S, N>(dof, S(100));
  }
};

/// A tangent vector of `G` whose rotations are below pi; `dof` matters for groups of run-time size.
template <LieGroup G>
typename G::Tangent draw_tangent(Eigen::Index dof) {
  return TangentDraw<G>::draw(dof);
}

template <LieGroup G>
G draw_element(Eigen::Index dof) {
  return G::exp(draw_tangent<G>(dof));
}

/// A symmetric positive definite matrix in the tangent space of `G`.
template <LieGroup G>
typename G::TangentMatrix draw_covariance(Eigen::Index dof) {
  using Matrix = typename G::TangentMatrix;
  using Scalar = typename G::Scalar;
  Matrix root = Matrix::Identity(dof, dof);
  for (Eigen::Index j = 0; j < dof; ++j) {
    root.col(j) += draw_vector<Scalar, Matrix::RowsAtCompileTime>(dof, Scalar(1));
  }
  const Matrix p = root * root.transpose() + Matrix::Identity(dof, dof);
  return mirror_upper(p);
}

#ifdef POSEMIX_TESTING_COMPILED
// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_LIE_DRAW(prefix, G)                                  \
  prefix template typename G::Tangent draw_tangent<G>(Eigen::Index); \
  prefix template G draw_element<G>(Eigen::Index);                   \
  prefix template typename G::TangentMatrix draw_covariance<G>(Eigen::Index)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_LIE_DRAW(extern, SO3d);
POSEMIX_LIE_DRAW(extern, SE3d);
POSEMIX_LIE_DRAW(extern, PoseStackd);
POSEMIX_LIE_DRAW(extern, Rnd<3>);
#endif

}  // namespace posemix::testing
