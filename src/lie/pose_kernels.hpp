// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <span>

#include "posemix/base/linear.hpp"
#include "posemix/lie/lie.hpp"

/// SE3's functions on many poses at once, with the widest vector instructions of the machine.
/// se3.hpp is the reference. A result does not depend on the number of poses or on their order.
namespace posemix::internal {

/// Squared angle [rad^2] up to which vectors are evaluated by series; beyond, one by one.
inline constexpr double kLargestSquaredAngle = 4.0 * small_angle::kSeriesBelow;

/// Numbers in rows, `stride` apart: a pose has seven in a row, x y z w of the quaternion and the
/// translation, a tangent vector six, and the blocks a and b of [a 0; b a] eighteen, by columns.
struct ConstRows {
  const double* data;
  std::size_t stride;
};
struct MutableRows {
  double* data;
  std::size_t stride;
};

inline ConstRows rows_of(const SE3d* poses) {
  return {poses->rotation().quaternion().coeffs().data(), sizeof(SE3d) / sizeof(double)};
}
inline MutableRows rows_of(SE3d* poses) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): SE3 has no access to its numbers
  return {const_cast<double*>(poses->rotation().quaternion().coeffs().data()),
          sizeof(SE3d) / sizeof(double)};
}

/// Exp(xi) of `count` tangent vectors.
void exp_of(ConstRows xi, MutableRows poses, std::size_t count);
/// Exp(xi) X.
void exp_product_of(ConstRows xi, ConstRows poses, MutableRows result, std::size_t count);
/// Log(X).
void log_of(ConstRows poses, MutableRows xi, std::size_t count);
/// X Y.
void product_of(ConstRows x, ConstRows y, MutableRows result, std::size_t count);
/// X Y^-1.
void quotient_of(ConstRows x, ConstRows y, MutableRows result, std::size_t count);
/// The blocks of J_l(xi) and of its inverse.
void left_jacobian_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count);
void left_jacobian_inverse_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count);

/// Ad(X) P Ad(X)^T; a covariance has 36 numbers in a row. Exactly symmetric.
void adjoint_congruence_of(ConstRows poses, ConstRows covariances, MutableRows result,
                           std::size_t count);
/// Log(X Y Z^-1) of one X, as the residual of a detection Y by the camera X of an object at Z.
void residual_of(const SE3d& x, ConstRows y, ConstRows z, MutableRows xi, std::size_t count);

/// What the merge of two stacks needs of their poses, by pose: the mean, and the blocks by which
/// the covariance of either is moved and the distance of both, in the tangent space at one point.
/// Two weights with the sum one, of which one may be too small to be left of the other's difference
/// from it.
struct PairWeights {
  double first;
  double second;
};

struct MergedPoses {
  MutableRows mean;
  MutableRows first;
  MutableRows second;
  MutableRows distance;
};

/// Midway-merge paper, eq. 12: with dx = Log(X_2 X_1^-1) the mean is Exp(w_2 dx) X_1, the blocks
/// are J_l^-1(-w_2 dx) and J_l^-1(w_1 dx), the distance is dx.
void midway_of(ConstRows x_1, ConstRows x_2, const PairWeights& weights, const MergedPoses& result,
               std::size_t count);
/// The tangent space is that at X_1, and the sum of both is moved to its mean m = w_2 dx (Cesic et
/// al. 2017): the blocks are J_l(m) and J_l(m) J_l^-1(dx), the distance is J_l(m) dx.
void tangent_merge_of(ConstRows x_1, ConstRows x_2, const PairWeights& weights,
                      const MergedPoses& result, std::size_t count);

}  // namespace posemix::internal
