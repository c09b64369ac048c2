// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include "posemix/lie/batch_rows.hpp"
#include "posemix/lie/lie.hpp"

/// SE3's functions on many poses at once, with the widest vector instructions of the machine.
/// se3.hpp is the reference. A result does not depend on the number of poses or on their order.
namespace posemix::internal {

inline ConstPoseRows rows_of(const SE3d* poses) {
  constexpr std::size_t kStride = sizeof(SE3d) / sizeof(double);
  if (poses == nullptr) return {nullptr, nullptr, kStride};  // of no poses
  return {poses->rotation().quaternion().coeffs().data(), poses->translation().data(), kStride};
}
inline MutablePoseRows rows_of(SE3d* poses) {
  const ConstPoseRows rows = rows_of(static_cast<const SE3d*>(poses));
  // NOLINTBEGIN(cppcoreguidelines-pro-type-const-cast): SE3 has no access to its numbers
  return {const_cast<double*>(rows.rotation), const_cast<double*>(rows.translation), rows.stride};
  // NOLINTEND(cppcoreguidelines-pro-type-const-cast)
}

/// Exp(xi) X of `count` tangent vectors and poses.
void exp_product_of(ConstRows xi, ConstPoseRows poses, MutablePoseRows result, std::size_t count);
/// X Y^-1.
void quotient_of(ConstPoseRows x, ConstPoseRows y, MutablePoseRows result, std::size_t count);
/// Log(X Y Z^-1) of one X, as the residual of a detection Y by the camera X of an object at Z.
void residual_of(const SE3d& x, ConstPoseRows y, ConstPoseRows z, MutableRows xi,
                 std::size_t count);

/// Two weights with the sum one, of which one may be too small to be left of the other's difference
/// from it.
struct PairWeights {
  double first;
  double second;
};

/// What the merge of two stacks needs of their poses, by pose: the mean, and the blocks by which
/// the covariance of either is moved and the distance of both, in the tangent space at one point.
struct MergedPoses {
  MutablePoseRows mean;
  MutableRows first;
  MutableRows second;
  MutableRows distance;
};

/// Midway-merge paper, eq. 12: with dx = Log(X_2 X_1^-1) the mean is Exp(w_2 dx) X_1, the blocks
/// are J_l^-1(-w_2 dx) and J_l^-1(w_1 dx), the distance is dx.
void midway_of(ConstPoseRows x_1, ConstPoseRows x_2, const PairWeights& weights,
               const MergedPoses& result, std::size_t count);
/// The tangent space is that at X_1, and the sum of both is moved to its mean m = w_2 dx (Cesic et
/// al. 2017): the blocks are J_l(m) and J_l(m) J_l^-1(dx), the distance is J_l(m) dx.
void tangent_merge_of(ConstPoseRows x_1, ConstPoseRows x_2, const PairWeights& weights,
                      const MergedPoses& result, std::size_t count);

}  // namespace posemix::internal
