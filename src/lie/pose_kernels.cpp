// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "lie/pose_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pose_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "hwy/highway.h"
#include "lie/pose_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

void exp_rows(ConstRows xi, MutablePoseRows poses, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_poses(exp(load_tangents(xi, i, count)), poses, i, count);
}

void exp_product_rows(ConstRows xi, ConstPoseRows poses, MutablePoseRows result,
                      std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses moved = product(exp(load_tangents(xi, i, count)), load_poses(poses, i, count));
    store_poses(moved, result, i, count);
  }
}

void log_rows(ConstPoseRows poses, MutableRows xi, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_tangents(log(load_poses(poses, i, count)), xi, i, count);
}

void product_rows(ConstPoseRows x, ConstPoseRows y, MutablePoseRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_poses(product(load_poses(x, i, count), load_poses(y, i, count)), result, i, count);
}

void quotient_rows(ConstPoseRows x, ConstPoseRows y, MutablePoseRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses quotient = product(load_poses(x, i, count), inverse(load_poses(y, i, count)));
    store_poses(quotient, result, i, count);
  }
}

void jacobian_rows(ConstRows xi, MutableRows blocks, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_blocks(left_jacobian(load_tangents(xi, i, count)), blocks, i, count);
}

void inverse_jacobian_rows(ConstRows xi, MutableRows blocks, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_blocks(left_jacobian_inverse(load_tangents(xi, i, count)), blocks, i, count);
}

HWY_INLINE Tangents scaled(V s, const Tangents& xi) {
  return {scaled(s, xi.phi), scaled(s, xi.rho)};
}

/// dx by the body's axes, Log(X_1^-1 X_2) = Ad(X_1^-1) dx, which does not lose digits far from the
/// origin.
void midway_rows(ConstPoseRows x_1, ConstPoseRows x_2, const PairWeights& weights,
                 const MergedPoses& result, std::size_t count) {
  const V w_2 = set(weights.second);
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses first = load_poses(x_1, i, count);
    const Tangents body = log(product(inverse(first), load_poses(x_2, i, count)));
    const Tangents dx = times(adjoint(first), body);
    store_poses(product(first, exp(scaled(w_2, body))), result.mean, i, count);
    store_blocks(left_jacobian_inverse(scaled(hn::Neg(w_2), dx)), result.first, i, count);
    store_blocks(left_jacobian_inverse(scaled(set(weights.first), dx)), result.second, i, count);
    store_tangents(dx, result.distance, i, count);
  }
}

HWY_INLINE Matrices product(const Matrices& a, const Matrices& b) {
  Matrices result;
  for (std::size_t column = 0; column < 9; column += 3) {
    const V3 one = times(a, {b.m[column], b.m[column + 1], b.m[column + 2]});
    result.m[column] = one.x;
    result.m[column + 1] = one.y;
    result.m[column + 2] = one.z;
  }
  return result;
}

void adjoint_congruence_rows(ConstPoseRows poses, ConstRows covariances, MutableRows result,
                             std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const TwistMatrices ad = adjoint(load_poses(poses, i, count));
    store_symmetric(congruence(ad, load_symmetric(covariances, i, count)), result, i, count);
  }
}

void residual_rows(ConstPoseRows x, ConstPoseRows y, ConstPoseRows z, MutableRows xi,
                   std::size_t count) {
  const Poses first = load_poses(x, 0, 1);
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses detected = product(first, load_poses(y, i, count));
    store_tangents(log(product(detected, inverse(load_poses(z, i, count)))), xi, i, count);
  }
}

HWY_INLINE TwistMatrices product(const TwistMatrices& x, const TwistMatrices& y) {
  TwistMatrices result{product(x.a, y.a), product(x.b, y.a)};
  const Matrices rest = product(x.a, y.b);
  for (std::size_t k = 0; k < 9; ++k) result.b.m[k] = hn::Add(result.b.m[k], rest.m[k]);
  return result;
}

void tangent_merge_rows(ConstPoseRows x_1, ConstPoseRows x_2, const PairWeights& weights,
                        const MergedPoses& result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses first = load_poses(x_1, i, count);
    const Tangents dx = log(product(load_poses(x_2, i, count), inverse(first)));
    const Tangents mean = scaled(set(weights.second), dx);
    const TwistMatrices back = left_jacobian(mean);
    store_poses(product(exp(mean), first), result.mean, i, count);
    store_blocks(back, result.first, i, count);
    store_blocks(product(back, left_jacobian_inverse(dx)), result.second, i, count);
    store_tangents(times(back, dx), result.distance, i, count);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(exp_rows);
HWY_EXPORT(exp_product_rows);
HWY_EXPORT(log_rows);
HWY_EXPORT(product_rows);
HWY_EXPORT(quotient_rows);
HWY_EXPORT(jacobian_rows);
HWY_EXPORT(inverse_jacobian_rows);
HWY_EXPORT(adjoint_congruence_rows);
HWY_EXPORT(residual_rows);
HWY_EXPORT(midway_rows);
HWY_EXPORT(tangent_merge_rows);

void exp_of(ConstRows xi, MutablePoseRows poses, std::size_t count) {
  POSEMIX_DISPATCH(exp_rows)(xi, poses, count);
}

void exp_product_of(ConstRows xi, ConstPoseRows poses, MutablePoseRows result, std::size_t count) {
  POSEMIX_DISPATCH(exp_product_rows)(xi, poses, result, count);
}

void log_of(ConstPoseRows poses, MutableRows xi, std::size_t count) {
  POSEMIX_DISPATCH(log_rows)(poses, xi, count);
}

void product_of(ConstPoseRows x, ConstPoseRows y, MutablePoseRows result, std::size_t count) {
  POSEMIX_DISPATCH(product_rows)(x, y, result, count);
}

void quotient_of(ConstPoseRows x, ConstPoseRows y, MutablePoseRows result, std::size_t count) {
  POSEMIX_DISPATCH(quotient_rows)(x, y, result, count);
}

void left_jacobian_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count) {
  POSEMIX_DISPATCH(jacobian_rows)(xi, blocks, count);
}

void left_jacobian_inverse_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count) {
  POSEMIX_DISPATCH(inverse_jacobian_rows)(xi, blocks, count);
}

void adjoint_congruence_of(ConstPoseRows poses, ConstRows covariances, MutableRows result,
                           std::size_t count) {
  POSEMIX_DISPATCH(adjoint_congruence_rows)(poses, covariances, result, count);
}

void residual_of(const SE3d& x, ConstPoseRows y, ConstPoseRows z, MutableRows xi,
                 std::size_t count) {
  POSEMIX_DISPATCH(residual_rows)(rows_of(&x), y, z, xi, count);
}

void midway_of(ConstPoseRows x_1, ConstPoseRows x_2, const PairWeights& weights,
               const MergedPoses& result, std::size_t count) {
  POSEMIX_DISPATCH(midway_rows)(x_1, x_2, weights, result, count);
}

void tangent_merge_of(ConstPoseRows x_1, ConstPoseRows x_2, const PairWeights& weights,
                      const MergedPoses& result, std::size_t count) {
  POSEMIX_DISPATCH(tangent_merge_rows)(x_1, x_2, weights, result, count);
}

}  // namespace posemix::internal
#endif
