// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/lie/twist_matrix.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "twist_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

#if HWY_MAX_BYTES >= 32

namespace hn = hwy::HWY_NAMESPACE;
// Three rows of a matrix, and a lane that is not used.
using D4 = hn::FixedTag<double, 4>;
using V4 = hn::Vec<D4>;

HWY_INLINE V4 each(const double* value) { return hn::Set(D4(), *value); }

/// The columns of a 3x3 matrix; what follows the first two is read.
struct Columns {
  V4 c[3];
  HWY_INLINE explicit Columns(const double* m)
      : c{hn::LoadU(D4(), m), hn::LoadU(D4(), m + 3),
          hn::MaskedLoad(hn::FirstN(D4(), 3), D4(), m + 6)} {}
};

/// sum + x v.
HWY_INLINE V4 add_product(const V4* x, const double* v, std::size_t stride, V4 sum) {
  POSEMIX_UNROLL
  for (std::size_t k = 0; k < 3; ++k) sum = hn::MulAdd(x[k], each(v + k * stride), sum);
  return sum;
}
/// x v.
HWY_INLINE V4 product(const V4* x, const double* v, std::size_t stride) {
  V4 sum = hn::Mul(x[0], each(v));
  POSEMIX_UNROLL
  for (std::size_t k = 1; k < 3; ++k) sum = hn::MulAdd(x[k], each(v + k * stride), sum);
  return sum;
}

/// The rows of a matrix of three columns, as columns.
HWY_INLINE void transpose(const V4* m, V4* result) {
  const V4 zero = hn::Zero(D4());
  const V4 even = hn::InterleaveLower(D4(), m[0], m[1]);
  const V4 odd = hn::InterleaveUpper(D4(), m[0], m[1]);
  const V4 even_2 = hn::InterleaveLower(D4(), m[2], zero);
  const V4 odd_2 = hn::InterleaveUpper(D4(), m[2], zero);
  result[0] = hn::ConcatLowerLower(D4(), even_2, even);
  result[1] = hn::ConcatLowerLower(D4(), odd_2, odd);
  result[2] = hn::ConcatUpperUpper(D4(), even_2, even);
}

/// The upper triangle in the place of the lower one, too.
HWY_INLINE void mirror(V4* m) {
  V4 rows[3];
  transpose(m, rows);
  m[0] = hn::IfThenElse(hn::FirstN(D4(), 1), m[0], rows[0]);
  m[1] = hn::IfThenElse(hn::FirstN(D4(), 2), m[1], rows[1]);
}

/// A column of a matrix by its upper and lower half, two entries at a time, as Eigen's baseline
/// reads them next: a read of what was written in two pieces has to wait.
HWY_INLINE void store_column(V4 upper, V4 lower, double* m) {
  using D2 = hn::FixedTag<double, 2>;
  const auto first = hn::LowerHalf(D2(), lower);
  hn::StoreU(hn::LowerHalf(D2(), upper), D2(), m);
  hn::StoreU(hn::InterleaveLower(D2(), hn::UpperHalf(D2(), upper), first), D2(), m + 2);
  hn::StoreU(hn::CombineShiftRightBytes<8>(D2(), hn::UpperHalf(D2(), lower), first), D2(), m + 4);
}

/// [a 0; b a] p [a 0; b a]^T of one p: columns of the products in registers, multiplied by entries
/// of p, a and b.
void congruence(const TwistMatrix<double>& w, const double* p, double* m) {
  const double* a = w.a.data();
  const double* b = w.b.data();
  const Columns columns_a(a);
  const Columns columns_b(b);
  // [a 0; b a] p; of the upper half three columns are enough.
  V4 above[3];
  V4 below[6];
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) {
    below[c] = add_product(columns_a.c, p + 6 * c + 3, 1, product(columns_b.c, p + 6 * c, 1));
    if (c < 3) above[c] = product(columns_a.c, p + 6 * c, 1);
  }
  V4 upper[6];
  V4 lower[6];
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 3; ++c) {
    upper[c] = product(above, a + c, 3);
    lower[c] = product(below, a + c, 3);
    lower[3 + c] = add_product(below + 3, a + c, 3, product(below, b + c, 3));
  }
  mirror(upper);
  mirror(lower + 3);
  transpose(lower, upper + 3);
  POSEMIX_UNROLL
  for (std::size_t c = 0; c < 6; ++c) store_column(upper[c], lower[c], m + 6 * c);
}

#else

void congruence(const TwistMatrix<double>& w, const double* p, double* m) {
  using Dense = TwistMatrix<double>::Dense;
  Eigen::Map<Dense> result(m);
  result = w.congruence_by_products(Eigen::Map<const Dense>(p));
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix {
namespace internal {
HWY_EXPORT(congruence);
}  // namespace internal

template <>
TwistMatrix<double>::Dense TwistMatrix<double>::congruence(const Dense& p) const {
  using namespace internal;
  Dense m;
  POSEMIX_DISPATCH(congruence)(*this, p.data(), m.data());
  return m;
}

}  // namespace posemix
#endif
