// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/batch_rows.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rotation_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "hwy/highway.h"
#include "lie/pose_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

HWY_INLINE V3 load_vectors(ConstRows rows, std::size_t i, std::size_t count) {
  V f[3];
  InputRows<3>{rows.data, rows.stride, count}.load(i, f);
  return {f[0], f[1], f[2]};
}
HWY_INLINE Quaternion load_rotations(ConstRows rows, std::size_t i, std::size_t count) {
  V f[4];
  InputRows<4>{rows.data, rows.stride, count}.load(i, f);
  return {{f[0], f[1], f[2]}, f[3]};
}
HWY_INLINE void store_rotations(const Quaternion& q, MutableRows rows, std::size_t i,
                                std::size_t count) {
  const V f[] = {q.v.x, q.v.y, q.v.z, q.w};
  OutputRows<4>{rows.data, rows.stride, count}.store(f, i);
}

void so3_exp_rows(ConstRows phi, MutableRows rotations, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_rotations(exp(load_vectors(phi, i, count)), rotations, i, count);
}

void so3_log_rows(ConstRows rotations, MutableRows phi, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const V3 found = log(load_rotations(rotations, i, count));
    const V f[] = {found.x, found.y, found.z};
    OutputRows<3>{phi.data, phi.stride, count}.store(f, i);
  }
}

/// jacobian(phi) for all vectors of rotation vectors.
template <class Jacobian>
HWY_INLINE void so3_matrix_rows(ConstRows phi, MutableMatrices result, std::size_t count,
                                const Jacobian& jacobian) {
  const V sign = set(result.by_rows ? -1.0 : 1.0);
  for (std::size_t i = 0; i < count; i += kLanes) {
    // J_l(phi)^T = J_l(-phi).
    const Matrices found = jacobian(scaled(sign, load_vectors(phi, i, count)));
    OutputRows<9>{result.data, result.stride, count}.store(found.m, i);
  }
}

void so3_jacobian_rows(ConstRows phi, MutableMatrices result, std::size_t count) {
  so3_matrix_rows(phi, result, count, [](const V3& one) HWY_ATTR { return left_jacobian(one); });
}
void so3_inverse_jacobian_rows(ConstRows phi, MutableMatrices result, std::size_t count) {
  so3_matrix_rows(phi, result, count,
                  [](const V3& one) HWY_ATTR { return left_jacobian_inverse(one); });
}

void so3_product_rows(ConstRows x, ConstRows y, MutableRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Quaternion found = product(load_rotations(x, i, count), load_rotations(y, i, count));
    store_rotations(renormalised(found), result, i, count);
  }
}

void so3_inverse_rows(ConstRows x, MutableRows result, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kLanes)
    store_rotations(conjugate(load_rotations(x, i, count)), result, i, count);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(so3_exp_rows);
HWY_EXPORT(so3_log_rows);
HWY_EXPORT(so3_jacobian_rows);
HWY_EXPORT(so3_inverse_jacobian_rows);
HWY_EXPORT(so3_product_rows);
HWY_EXPORT(so3_inverse_rows);

void so3_exp_of(ConstRows phi, MutableRows rotations, std::size_t count) {
  POSEMIX_DISPATCH(so3_exp_rows)(phi, rotations, count);
}

void so3_log_of(ConstRows rotations, MutableRows phi, std::size_t count) {
  POSEMIX_DISPATCH(so3_log_rows)(rotations, phi, count);
}

void so3_left_jacobian_of(ConstRows phi, MutableMatrices result, std::size_t count) {
  POSEMIX_DISPATCH(so3_jacobian_rows)(phi, result, count);
}

void so3_left_jacobian_inverse_of(ConstRows phi, MutableMatrices result, std::size_t count) {
  POSEMIX_DISPATCH(so3_inverse_jacobian_rows)(phi, result, count);
}

void so3_product_of(ConstRows x, ConstRows y, MutableRows result, std::size_t count) {
  POSEMIX_DISPATCH(so3_product_rows)(x, y, result, count);
}

void so3_inverse_of(ConstRows x, MutableRows result, std::size_t count) {
  POSEMIX_DISPATCH(so3_inverse_rows)(x, result, count);
}

}  // namespace posemix::internal
#endif
