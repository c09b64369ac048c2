// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Rows of poses, tangent vectors and blocks as vectors with one lane for each. Included once for
// every set of vector instructions.
#if defined(POSEMIX_POSE_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_POSE_ROWS_INL
#undef POSEMIX_POSE_ROWS_INL
#else
#define POSEMIX_POSE_ROWS_INL
#endif

#include "base/fields-inl.hpp"
#include "lie/pose_kernels.hpp"
#include "lie/pose_vector-inl.hpp"
#include "lie/twist_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

HWY_INLINE Tangents load_tangents(ConstRows rows, std::size_t i, std::size_t count) {
  V f[6];
  InputRows<6>{rows.data, rows.stride, count}.load(i, f);
  return {{f[0], f[1], f[2]}, {f[3], f[4], f[5]}};
}
HWY_INLINE Poses load_poses(ConstPoseRows rows, std::size_t i, std::size_t count) {
  V q[4];
  V t[3];
  InputRows<4>{rows.rotation, rows.stride, count}.load(i, q);
  InputRows<3>{rows.translation, rows.stride, count}.load(i, t);
  return {{{q[0], q[1], q[2]}, q[3]}, {t[0], t[1], t[2]}};
}
/// The lower triangle of symmetric matrices.
HWY_INLINE Symmetric load_symmetric(ConstRows rows, std::size_t i, std::size_t count) {
  V f[36];
  InputRows<36>{rows.data, rows.stride, count}.load(i, f);
  Symmetric p;
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) {
      if (r >= c) p.m[lower_index(r, c)] = f[6 * c + r];
    }
  }
  return p;
}

HWY_INLINE void store_tangents(const Tangents& xi, MutableRows rows, std::size_t i,
                               std::size_t count) {
  const V f[] = {xi.phi.x, xi.phi.y, xi.phi.z, xi.rho.x, xi.rho.y, xi.rho.z};
  OutputRows<6>{rows.data, rows.stride, count}.store(f, i);
}
HWY_INLINE void store_poses(const Poses& x, MutablePoseRows rows, std::size_t i,
                            std::size_t count) {
  const V q[] = {x.rotation.v.x, x.rotation.v.y, x.rotation.v.z, x.rotation.w};
  const V t[] = {x.translation.x, x.translation.y, x.translation.z};
  OutputRows<4>{rows.rotation, rows.stride, count}.store(q, i);
  OutputRows<3>{rows.translation, rows.stride, count}.store(t, i);
}
HWY_INLINE void store_symmetric(const Symmetric& p, MutableRows rows, std::size_t i,
                                std::size_t count) {
  V f[36];
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r) f[6 * c + r] = p.at(r, c);
  }
  OutputRows<36>{rows.data, rows.stride, count}.store(f, i);
}
HWY_INLINE void store_blocks(const TwistMatrices& x, MutableRows rows, std::size_t i,
                             std::size_t count) {
  V f[18];
  for (std::size_t k = 0; k < 9; ++k) {
    f[k] = x.a.m[k];
    f[9 + k] = x.b.m[k];
  }
  OutputRows<18>{rows.data, rows.stride, count}.store(f, i);
}
/// [a 0; b a] as 6x6 matrices, by rows or by columns.
template <bool kByRows>
HWY_INLINE void store_dense(const TwistMatrices& x, MutableRows rows, std::size_t i,
                            std::size_t count) {
  V f[36];
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    POSEMIX_UNROLL
    for (std::size_t r = 0; r < 6; ++r)
      f[kByRows ? 6 * r + c : 6 * c + r] = r < 3 && c >= 3 ? hn::Zero(D()) : entry(x, r, c);
  }
  OutputRows<36>{rows.data, rows.stride, count}.store(f, i);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
