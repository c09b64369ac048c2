// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Weighted moments of the samples of a block. Included once for every set of vector instructions.
#if defined(POSEMIX_EM_MOMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_EM_MOMENTS_INL
#undef POSEMIX_EM_MOMENTS_INL
#else
#define POSEMIX_EM_MOMENTS_INL
#endif

#include "base/vector_targets.hpp"
#include "em_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Coordinates that stand in rows.
struct StoredRows {
  const EmRow* rows;

  HWY_INLINE V at(std::size_t j, std::size_t i) const { return load(rows[j], i); }
};

/// Row kRow of the moments: first += s, second_j += s y_j.
template <int kRow>
struct MomentRow {
  V first;
  V second[kRow + 1];

  HWY_INLINE MomentRow(std::size_t n, const double* sums) : first(load_sum(sums, 1 + kRow)) {
    POSEMIX_UNROLL
    for (std::size_t j = 0; j <= kRow; ++j)
      second[j] = load_sum(sums, em_second_moment(n, kRow, j));
  }
  HWY_INLINE void add(const V* y, V share) {
    const V shared = hn::Mul(share, y[kRow]);
    first = hn::Add(first, shared);
    POSEMIX_UNROLL
    for (int j = 0; j <= kRow; ++j) second[j] = hn::MulAdd(shared, y[j], second[j]);
  }
  HWY_INLINE void save(std::size_t n, double* sums) const {
    store_sum(first, sums, 1 + kRow);
    POSEMIX_UNROLL
    for (std::size_t j = 0; j <= kRow; ++j)
      store_sum(second[j], sums, em_second_moment(n, kRow, j));
  }
};

/// The first kRows rows of the moments, and the weight. All sums are members, one vector each, so
/// that they stay in registers.
template <int kRows>
struct MomentRows {
  MomentRows<kRows - 1> before;
  MomentRow<kRows - 1> last;

  HWY_INLINE MomentRows(std::size_t n, const double* sums) : before(n, sums), last(n, sums) {}
  HWY_INLINE void add(const V* y, V share) {
    before.add(y, share);
    last.add(y, share);
  }
  HWY_INLINE void save(std::size_t n, double* sums) const {
    before.save(n, sums);
    last.save(n, sums);
  }
};

template <>
struct MomentRows<0> {
  V weight;

  HWY_INLINE MomentRows(std::size_t, const double* sums) : weight(load_sum(sums, 0)) {}
  HWY_INLINE void add(const V*, V share) { weight = hn::Add(weight, share); }
  HWY_INLINE void save(std::size_t, double* sums) const { store_sum(weight, sums, 0); }
};

template <int kN, class Rows>
void add_moments_of(const Rows& y, const EmRow& shares, std::size_t count, double* sums) {
  MomentRows<kN> moments(kN, sums);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V share = load(shares, i);
    if (none(share)) continue;
    V v[kN];
    POSEMIX_UNROLL
    for (std::size_t j = 0; j < kN; ++j) v[j] = y.at(j, i);
    moments.add(v, share);
  }
  moments.save(kN, sums);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
