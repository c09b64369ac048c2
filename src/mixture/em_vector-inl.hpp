// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Rows of samples and small sums, for at most eight samples at a time. Included once for every set
// of vector instructions.
#if defined(POSEMIX_EM_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_EM_VECTOR_INL
#undef POSEMIX_EM_VECTOR_INL
#else
#define POSEMIX_EM_VECTOR_INL
#endif

#include "hwy/highway.h"
#include "lie/half_angle-inl.hpp"
#include "posemix/mixture/em_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Sum number k, and where it is kept: once for every block, and so without alignment.
HWY_INLINE V load_sum(const double* sums, std::size_t k) {
  return hn::LoadU(D(), sums + k * kEmSumLanes);
}
HWY_INLINE void store_sum(V v, double* sums, std::size_t k) {
  hn::StoreU(v, D(), sums + k * kEmSumLanes);
}

HWY_INLINE V load(const double* at) { return hn::Load(D(), at); }
HWY_INLINE V load(const EmRow& row, std::size_t i) { return hn::Load(D(), row.data() + i); }
HWY_INLINE void store(V v, EmRow& row, std::size_t i) { hn::Store(v, D(), row.data() + i); }

HWY_INLINE V3 load3(const EmRow* rows, std::size_t i) {
  return {load(rows[0], i), load(rows[1], i), load(rows[2], i)};
}
HWY_INLINE void store3(const V3& v, EmRow* rows, std::size_t i) {
  store(v.x, rows[0], i);
  store(v.y, rows[1], i);
  store(v.z, rows[2], i);
}

HWY_INLINE Quaternion load_rotation(const EmRow* samples, std::size_t i) {
  return {load3(samples, i), load(samples[3], i)};
}
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
