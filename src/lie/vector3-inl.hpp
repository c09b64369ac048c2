// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Vectors of three and quaternions, at most eight at a time, one per lane. Included once for every
// set of vector instructions.
#if defined(POSEMIX_VECTOR3_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_VECTOR3_INL
#undef POSEMIX_VECTOR3_INL
#else
#define POSEMIX_VECTOR3_INL
#endif

#include "base/vectors-inl.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 set3(const double* v) { return {set(v[0]), set(v[1]), set(v[2])}; }
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
/// a x b + c.
HWY_INLINE V3 cross_sum(const V3& a, const V3& b, const V3& c) {
  return {hn::MulAdd(a.y, b.z, hn::NegMulAdd(a.z, b.y, c.x)),
          hn::MulAdd(a.z, b.x, hn::NegMulAdd(a.x, b.z, c.y)),
          hn::MulAdd(a.x, b.y, hn::NegMulAdd(a.y, b.x, c.z))};
}
/// s a - b.
HWY_INLINE V3 scaled_difference(V s, const V3& a, const V3& b) {
  return {hn::MulSub(s, a.x, b.x), hn::MulSub(s, a.y, b.y), hn::MulSub(s, a.z, b.z)};
}
/// s a + b.
HWY_INLINE V3 scaled_sum(V s, const V3& a, const V3& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
HWY_INLINE V3 scaled(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE V3 negated(const V3& a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }

struct Quaternion {
  V3 v;
  V w;
};

HWY_INLINE Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {scaled_sum(a.w, b.v, scaled_sum(b.w, a.v, cross(a.v, b.v))),
          hn::MulSub(a.w, b.w, dot(a.v, b.v))};
}
HWY_INLINE Quaternion conjugate(const Quaternion& q) { return {negated(q.v), q.w}; }
/// One Newton step towards |q| = 1, as in SO3.
HWY_INLINE Quaternion renormalised(const Quaternion& q) {
  const V squared = hn::MulAdd(q.w, q.w, dot(q.v, q.v));
  const V scale = hn::Mul(set(0.5), hn::Sub(set(3.0), squared));
  return {scaled(scale, q.v), hn::Mul(scale, q.w)};
}
/// R(q) p = p + 2 w (v x p) + 2 v x (v x p).
HWY_INLINE V3 turned(const Quaternion& q, const V3& p) {
  const V3 once = cross(scaled(set(2.0), q.v), p);
  return cross_sum(q.v, once, scaled_sum(q.w, once, p));
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
