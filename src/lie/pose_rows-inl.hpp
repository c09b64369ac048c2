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

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

HWY_INLINE Tangents load_tangents(ConstRows rows, std::size_t i, std::size_t count) {
  V f[6];
  InputRows<6>{rows.data, rows.stride, count}.load(i, f);
  return {{f[0], f[1], f[2]}, {f[3], f[4], f[5]}};
}
HWY_INLINE Poses load_poses(ConstRows rows, std::size_t i, std::size_t count) {
  V f[7];
  InputRows<7>{rows.data, rows.stride, count}.load(i, f);
  return {{{f[0], f[1], f[2]}, f[3]}, {f[4], f[5], f[6]}};
}

HWY_INLINE void store_tangents(const Tangents& xi, MutableRows rows, std::size_t i,
                               std::size_t count) {
  const V f[] = {xi.phi.x, xi.phi.y, xi.phi.z, xi.rho.x, xi.rho.y, xi.rho.z};
  OutputRows<6>{rows.data, rows.stride, count}.store(f, i);
}
HWY_INLINE void store_poses(const Poses& x, MutableRows rows, std::size_t i, std::size_t count) {
  const auto& [r, t] = x;
  const V f[] = {r.v.x, r.v.y, r.v.z, r.w, t.x, t.y, t.z};
  OutputRows<7>{rows.data, rows.stride, count}.store(f, i);
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

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
