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

/// Calls result(xi, i) for all vectors of tangent vectors. Returns whether an angle is beyond the
/// series.
template <class Result>
HWY_INLINE bool for_tangents(ConstRows rows, std::size_t count, const Result& result) {
  bool large = false;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Tangents xi = load_tangents(rows, i, count);
    result(xi, i);
    large = large || !hn::AllTrue(D(), hn::Lt(dot(xi.phi, xi.phi), set(kLargestSquaredAngle)));
  }
  return large;
}

bool exp_rows(ConstRows xi, MutableRows poses, std::size_t count) {
  return for_tangents(xi, count, [&](const Tangents& one, std::size_t i) HWY_ATTR {
    store_poses(exp(one), poses, i, count);
  });
}

bool exp_product_rows(ConstRows xi, ConstRows poses, MutableRows result, std::size_t count) {
  return for_tangents(xi, count, [&](const Tangents& one, std::size_t i) HWY_ATTR {
    store_poses(product(exp(one), load_poses(poses, i, count)), result, i, count);
  });
}

void log_rows(ConstRows poses, MutableRows xi, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_tangents(log(load_poses(poses, i, count)), xi, i, count);
}

void product_rows(ConstRows x, ConstRows y, MutableRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_poses(product(load_poses(x, i, count), load_poses(y, i, count)), result, i, count);
}

void quotient_rows(ConstRows x, ConstRows y, MutableRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses quotient = product(load_poses(x, i, count), inverse(load_poses(y, i, count)));
    store_poses(quotient, result, i, count);
  }
}

bool jacobian_rows(ConstRows xi, MutableRows blocks, std::size_t count) {
  return for_tangents(xi, count, [&](const Tangents& one, std::size_t i) HWY_ATTR {
    store_blocks(left_jacobian(one), blocks, i, count);
  });
}

bool inverse_jacobian_rows(ConstRows xi, MutableRows blocks, std::size_t count) {
  return for_tangents(xi, count, [&](const Tangents& one, std::size_t i) HWY_ATTR {
    store_blocks(left_jacobian_inverse(one), blocks, i, count);
  });
}

HWY_INLINE Tangents scaled(V s, const Tangents& xi) {
  return {scaled(s, xi.phi), scaled(s, xi.rho)};
}

/// dx by the body's axes, Log(X_1^-1 X_2) = Ad(X_1^-1) dx, which does not lose digits far from the
/// origin.
void midway_rows(ConstRows x_1, ConstRows x_2, const PairWeights& weights,
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

HWY_INLINE Matrices transposed(const Matrices& a) {
  const V* const m = a.m;
  return {{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}};
}
HWY_INLINE Matrices sum(const Matrices& a, const Matrices& b) {
  Matrices result;
  for (std::size_t k = 0; k < 9; ++k) result.m[k] = hn::Add(a.m[k], b.m[k]);
  return result;
}
/// t^ M.
HWY_INLINE Matrices cross(const V3& t, const Matrices& m) {
  Matrices result;
  for (std::size_t column = 0; column < 9; column += 3) {
    const V3 one = cross(t, V3{m.m[column], m.m[column + 1], m.m[column + 2]});
    result.m[column] = one.x;
    result.m[column + 1] = one.y;
    result.m[column + 2] = one.z;
  }
  return result;
}

/// A block of 6x6 matrices in rows of 36 numbers by columns.
HWY_INLINE Matrices block_of(const V* fields, std::size_t row, std::size_t column) {
  Matrices m;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) m.m[3 * c + r] = fields[6 * (column + c) + row + r];
  }
  return m;
}

/// With Ad = [I 0; t^ I] [R 0; 0 R]: first the blocks turn, then the translation acts.
void adjoint_congruence_rows(ConstRows poses, ConstRows covariances, MutableRows result,
                             std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Poses x = load_poses(poses, i, count);
    V p[36];
    InputRows<36>{covariances.data, covariances.stride, count}.load(i, p);
    const Matrices r = matrices(x.rotation);
    const Matrices r_t = transposed(r);
    const auto turn = [&](const Matrices& m) HWY_ATTR { return product(product(r, m), r_t); };
    const Matrices a = turn(block_of(p, 0, 0));
    const Matrices b = turn(block_of(p, 0, 3));
    const Matrices d = turn(block_of(p, 3, 3));
    // [a, a t^^T + b; ., t^ (a t^^T + b) + b^T t^^T + d], with m t^^T = (t^ m^T)^T.
    const Matrices upper = sum(transposed(cross(x.translation, transposed(a))), b);
    const Matrices lower =
        sum(cross(x.translation, upper), sum(transposed(cross(x.translation, b)), d));
    V values[36];
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t row = 0; row < 3; ++row) {
        const bool above = row <= c;
        values[6 * c + row] = above ? a.m[3 * c + row] : a.m[3 * row + c];
        values[6 * (3 + c) + 3 + row] = above ? lower.m[3 * c + row] : lower.m[3 * row + c];
        values[6 * (3 + c) + row] = upper.m[3 * c + row];
        values[6 * c + 3 + row] = upper.m[3 * row + c];
      }
    }
    OutputRows<36>{result.data, result.stride, count}.store(values, i);
  }
}

void residual_rows(ConstRows x, ConstRows y, ConstRows z, MutableRows xi, std::size_t count) {
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

void tangent_merge_rows(ConstRows x_1, ConstRows x_2, const PairWeights& weights,
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

namespace {

Vector6d tangent_at(ConstRows xi, std::size_t i) {
  return Eigen::Map<const Vector6d>(xi.data + i * xi.stride);
}

SE3d pose_at(ConstRows poses, std::size_t i) {
  const double* const row = poses.data + i * poses.stride;
  return {SO3d::from_stored_quaternion(Eigen::Quaterniond(row[3], row[0], row[1], row[2])),
          Eigen::Map<const Eigen::Vector3d>(row + 4)};
}

void write(const SE3d& pose, MutableRows rows, std::size_t i) {
  double* const row = rows.data + i * rows.stride;
  Eigen::Map<Eigen::Vector4d>{row} = pose.rotation().quaternion().coeffs();
  Eigen::Map<Eigen::Vector3d>(row + 4) = pose.translation();
}

/// Calls one(i) for the tangent vectors whose angle is beyond that of the vectors' series.
template <class One>
void for_large_angles(ConstRows xi, std::size_t count, const One& one) {
  for (std::size_t i = 0; i < count; ++i) {
    const double squared = tangent_at(xi, i).head<3>().squaredNorm();
    if (!(squared < kLargestSquaredAngle)) one(i);
  }
}

template <class Blocks>
void write_large_angles(ConstRows xi, MutableRows rows, std::size_t count, const Blocks& blocks) {
  for_large_angles(xi, count, [&](std::size_t i) {
    const TwistMatrix<double> m = blocks(tangent_at(xi, i));
    Eigen::Map<Eigen::Matrix3d>(rows.data + i * rows.stride) = m.a;
    Eigen::Map<Eigen::Matrix3d>(rows.data + i * rows.stride + 9) = m.b;
  });
}

}  // namespace

void exp_of(ConstRows xi, MutableRows poses, std::size_t count) {
  if (!POSEMIX_DISPATCH(exp_rows)(xi, poses, count)) return;
  for_large_angles(xi, count,
                   [&](std::size_t i) { write(SE3d::exp(tangent_at(xi, i)), poses, i); });
}

void exp_product_of(ConstRows xi, ConstRows poses, MutableRows result, std::size_t count) {
  if (!POSEMIX_DISPATCH(exp_product_rows)(xi, poses, result, count)) return;
  for_large_angles(xi, count, [&](std::size_t i) {
    write(SE3d::exp(tangent_at(xi, i)) * pose_at(poses, i), result, i);
  });
}

void log_of(ConstRows poses, MutableRows xi, std::size_t count) {
  POSEMIX_DISPATCH(log_rows)(poses, xi, count);
}

void product_of(ConstRows x, ConstRows y, MutableRows result, std::size_t count) {
  POSEMIX_DISPATCH(product_rows)(x, y, result, count);
}

void quotient_of(ConstRows x, ConstRows y, MutableRows result, std::size_t count) {
  POSEMIX_DISPATCH(quotient_rows)(x, y, result, count);
}

void left_jacobian_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count) {
  if (POSEMIX_DISPATCH(jacobian_rows)(xi, blocks, count))
    write_large_angles(xi, blocks, count, &SE3d::left_jacobian_blocks);
}

void left_jacobian_inverse_blocks_of(ConstRows xi, MutableRows blocks, std::size_t count) {
  if (POSEMIX_DISPATCH(inverse_jacobian_rows)(xi, blocks, count))
    write_large_angles(xi, blocks, count, &SE3d::left_jacobian_inverse_blocks);
}

void adjoint_congruence_of(ConstRows poses, ConstRows covariances, MutableRows result,
                           std::size_t count) {
  POSEMIX_DISPATCH(adjoint_congruence_rows)(poses, covariances, result, count);
}

void residual_of(const SE3d& x, ConstRows y, ConstRows z, MutableRows xi, std::size_t count) {
  POSEMIX_DISPATCH(residual_rows)(rows_of(&x), y, z, xi, count);
}

void midway_of(ConstRows x_1, ConstRows x_2, const PairWeights& weights, const MergedPoses& result,
               std::size_t count) {
  POSEMIX_DISPATCH(midway_rows)(x_1, x_2, weights, result, count);
}

void tangent_merge_of(ConstRows x_1, ConstRows x_2, const PairWeights& weights,
                      const MergedPoses& result, std::size_t count) {
  POSEMIX_DISPATCH(tangent_merge_rows)(x_1, x_2, weights, result, count);
}

}  // namespace posemix::internal
#endif
