// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Vectors of three, quaternions and small sums, for at most eight samples at a time. Included once
// for every set of vector instructions.
#if defined(POSEMIX_EM_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_EM_VECTOR_INL
#undef POSEMIX_EM_VECTOR_INL
#else
#define POSEMIX_EM_VECTOR_INL
#endif

#include "hwy/highway.h"
#include "posemix/mixture/em_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr std::size_t kSumStride = 8;

HWY_INLINE V load(const double* at) { return hn::Load(D(), at); }
HWY_INLINE V load(const EmRow& row, std::size_t i) { return hn::Load(D(), row.data() + i); }
HWY_INLINE void store(V v, EmRow& row, std::size_t i) { hn::Store(v, D(), row.data() + i); }
HWY_INLINE V set(double value) { return hn::Set(D(), value); }

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 load3(const EmRow* rows, std::size_t i) {
  return {load(rows[0], i), load(rows[1], i), load(rows[2], i)};
}
HWY_INLINE V3 set3(const double* v) { return {set(v[0]), set(v[1]), set(v[2])}; }
HWY_INLINE void store3(const V3& v, EmRow* rows, std::size_t i) {
  store(v.x, rows[0], i);
  store(v.y, rows[1], i);
  store(v.z, rows[2], i);
}
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
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

struct Quaternion {
  V3 v;
  V w;
};

HWY_INLINE Quaternion load_rotation(const EmRow* samples, std::size_t i) {
  return {load3(samples, i), load(samples[3], i)};
}
HWY_INLINE Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {scaled_sum(a.w, b.v, scaled_sum(b.w, a.v, cross(a.v, b.v))),
          hn::MulSub(a.w, b.w, dot(a.v, b.v))};
}

/// Powers of z = 2 c - 1, the variable of the polynomials.
struct Powers {
  V z, z2, z4;

  HWY_INLINE explicit Powers(V cosine)
      : z(hn::MulSub(set(2.0), cosine, set(1.0))), z2(hn::Mul(z, z)), z4(hn::Mul(z2, z2)) {}

  HWY_INLINE V part(const double* c, int first, int last) const {
    V sum = set(c[last]);
    for (int k = last - 4; k >= first; k -= 4) sum = hn::MulAdd(sum, z4, set(c[k]));
    return sum;
  }
  HWY_INLINE V polynomial(const double* c) const {
    static_assert(kAngleDegree == 20);
    const V even = hn::MulAdd(part(c, 2, 18), z2, part(c, 0, 20));
    const V odd = hn::MulAdd(part(c, 3, 19), z2, part(c, 1, 17));
    return hn::MulAdd(odd, z, even);
  }
};

/// sum_j matrix_ij y_j over j in [0, columns).
HWY_INLINE V row_times(const std::array<double, 6>& row, const V* y, int columns) {
  V sum = hn::Mul(set(row[0]), y[0]);
  for (int j = 1; j < columns; ++j)
    sum = hn::MulAdd(set(row[static_cast<std::size_t>(j)]), y[j], sum);
  return sum;
}

/// |L^-1 y|^2.
template <int kN>
HWY_INLINE V squared_norm(const std::array<std::array<double, 6>, 6>& factor, const V* y) {
  V sum = hn::Zero(D());
  for (int i = 0; i < kN; ++i) {
    const V white = row_times(factor[static_cast<std::size_t>(i)], y, i + 1);
    sum = hn::MulAdd(white, white, sum);
  }
  return sum;
}

HWY_INLINE bool none(V share) { return hn::AllTrue(D(), hn::Eq(share, hn::Zero(D()))); }

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
