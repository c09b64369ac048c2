// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Functions of the angle of a rotation from its quaternion. Included once for every set of vector
// instructions.
#if defined(POSEMIX_HALF_ANGLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_HALF_ANGLE_INL
#undef POSEMIX_HALF_ANGLE_INL
#else
#define POSEMIX_HALF_ANGLE_INL
#endif

#include "hwy/highway.h"
#include "lie/half_angle_polynomials.hpp"
#include "lie/vector3-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

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

/// Below this squared angle the coefficients of the inverse Jacobian are taken from their series.
constexpr double kSeriesBelow = 1e-2;

/// sum of c[k] u^k, k = 0 ... 4.
HWY_INLINE V series(V u, const double (&c)[5]) {
  const V low = hn::MulAdd(u, set(c[1]), set(c[0]));
  const V high = hn::MulAdd(u, set(c[3]), set(c[2]));
  const V u2 = hn::Mul(u, u);
  return hn::MulAdd(hn::MulAdd(u2, set(c[4]), high), u2, low);
}

/// D = (1 - (t/2) cot(t/2)) / u with u = t^2, from (t/2) / sin(t/2), cos(t/2) and four times the
/// square of the former. The digits that D loses for small u do not matter, because it is
/// multiplied by u.
HWY_INLINE V second_order_of(V ratio, V cosine, V four_ratio_squared) {
  const V u = hn::Mul(four_ratio_squared, hn::NegMulAdd(cosine, cosine, set(1.0)));
  const V closed = hn::Div(hn::NegMulAdd(ratio, cosine, set(1.0)), u);
  const V small = series(u, {1.0 / 12, 1.0 / 720, 1.0 / 30240, 1.0 / 1209600, 1.0 / 47900160});
  return hn::IfThenElse(hn::Lt(u, set(kSeriesBelow)), small, closed);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
