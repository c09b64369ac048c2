// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Poses, at most eight at a time, one per lane: Exp, Log and their Jacobians as in so3.hpp and
// se3.hpp, which are the reference. Included once for every set of vector instructions.
#if defined(POSEMIX_POSE_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_POSE_VECTOR_INL
#undef POSEMIX_POSE_VECTOR_INL
#else
#define POSEMIX_POSE_VECTOR_INL
#endif

#include <array>
#include <cstddef>

#include "hwy/highway.h"
#include "lie/half_angle-inl.hpp"
#include "posemix/lie/small_angle.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

struct Poses {
  Quaternion rotation;
  V3 translation;
};

HWY_INLINE Poses product(const Poses& a, const Poses& b) {
  const V3 t = turned(a.rotation, b.translation);
  return {renormalised(product(a.rotation, b.rotation)),
          {hn::Add(t.x, a.translation.x), hn::Add(t.y, a.translation.y),
           hn::Add(t.z, a.translation.z)}};
}
HWY_INLINE Poses inverse(const Poses& a) {
  const Quaternion back = conjugate(a.rotation);
  return {back, negated(turned(back, a.translation))};
}

/// Tangent vectors.
struct Tangents {
  V3 phi;
  V3 rho;
};

/// The polynomial of small_angle, by the same scheme.
template <std::size_t kN>
HWY_INLINE V polynomial(const std::array<V, kN>& c, V u) {
  if constexpr (kN == 1) {
    return c[0];
  } else {
    std::array<V, (kN + 1) / 2> pairs;
    for (std::size_t k = 0; k < kN / 2; ++k) pairs[k] = hn::MulAdd(c[2 * k + 1], u, c[2 * k]);
    if constexpr (kN % 2 == 1) pairs[kN / 2] = c[kN - 1];
    return polynomial(pairs, hn::Mul(u, u));
  }
}
template <std::size_t kN>
HWY_INLINE V polynomial(const std::array<double, kN>& c, V u) {
  std::array<V, (kN + 1) / 2> pairs;
  for (std::size_t k = 0; k < kN / 2; ++k)
    pairs[k] = hn::MulAdd(set(c[2 * k + 1]), u, set(c[2 * k]));
  if constexpr (kN % 2 == 1) pairs[kN / 2] = set(c[kN - 1]);
  return polynomial(pairs, hn::Mul(u, u));
}

/// cos and sinc of half the angle by their series, for u = theta^2 < kLargestSquaredAngle.
struct Half {
  V cosine;
  V sinc;

  HWY_INLINE explicit Half(V u) {
    const auto& series = small_angle::detail::sine_series<double>();
    const V w = hn::Mul(set(0.25), u);
    cosine = hn::NegMulAdd(w, polynomial(series.b, w), set(1.0));
    sinc = polynomial(series.a, w);
  }
};

HWY_INLINE Poses exp(const Tangents& xi) {
  const V u = dot(xi.phi, xi.phi);
  const Half half(u);
  const V a = hn::Mul(half.sinc, half.cosine);
  const V b = hn::Mul(set(0.5), hn::Mul(half.sinc, half.sinc));
  const V c = hn::IfThenElseZero(hn::Gt(u, hn::Zero(D())), hn::Div(hn::Sub(set(1.0), a), u));
  const V along = hn::Mul(c, dot(xi.phi, xi.rho));
  return {renormalised({scaled(hn::Mul(set(0.5), half.sinc), xi.phi), half.cosine}),
          scaled_sum(along, xi.phi, scaled_sum(b, cross(xi.phi, xi.rho), scaled(a, xi.rho)))};
}

/// The quaternion's sign with which w >= 0, or of w = 0 the first component of v that is not zero.
HWY_INLINE V positive_sign(const Quaternion& q) {
  const V zero = hn::Zero(D());
  V deciding = hn::IfThenElse(hn::Eq(q.v.y, zero), q.v.z, q.v.y);
  deciding = hn::IfThenElse(hn::Eq(q.v.x, zero), deciding, q.v.x);
  deciding = hn::IfThenElse(hn::Eq(q.w, zero), deciding, q.w);
  return hn::And(deciding, hn::SignBit(D()));
}

/// rho = t - phi x t / 2 + D phi x (phi x t).
HWY_INLINE Tangents log(const Poses& x) {
  const V cosine = hn::Min(hn::Abs(x.rotation.w), set(1.0));
  const V ratio = Powers(cosine).polynomial(kHalfAngleOverSine);
  const V twice = hn::Add(ratio, ratio);
  const V3 phi = scaled(hn::Xor(twice, positive_sign(x.rotation)), x.rotation.v);
  const V second_order = second_order_of(ratio, cosine, hn::Mul(twice, twice));
  const V3 once = cross(phi, x.translation);
  const V3 both = scaled_sum(second_order, cross(phi, once), x.translation);
  return {phi, scaled_sum(set(-0.5), once, both)};
}

/// 3x3 matrices by columns.
struct Matrices {
  V m[9];
};

/// d I + w^ + p q^T + q p^T.
HWY_INLINE Matrices hat_plus_symmetric(V d, const V3& w, const V3& p, const V3& q) {
  const V xy = hn::MulAdd(p.x, q.y, hn::Mul(p.y, q.x));
  const V xz = hn::MulAdd(p.x, q.z, hn::Mul(p.z, q.x));
  const V yz = hn::MulAdd(p.y, q.z, hn::Mul(p.z, q.y));
  const auto diagonal = [&](V a, V b) HWY_ATTR { return hn::MulAdd(hn::Add(a, a), b, d); };
  return {{diagonal(p.x, q.x), hn::Add(xy, w.z), hn::Sub(xz, w.y),  //
           hn::Sub(xy, w.z), diagonal(p.y, q.y), hn::Add(yz, w.x),  //
           hn::Add(xz, w.y), hn::Sub(yz, w.x), diagonal(p.z, q.z)}};
}

/// The blocks of matrices [a 0; b a].
struct TwistMatrices {
  Matrices a;
  Matrices b;
};

/// A coefficient by its series where that holds, else in closed form.
template <class Coefficients>
HWY_INLINE Coefficients coefficients(V u) {
  const auto small = hn::Lt(u, set(small_angle::kSeriesBelow));
  if (hn::AllTrue(D(), small)) return Coefficients::by_series(u);
  const Coefficients closed = Coefficients::in_closed_form(u);
  if (hn::AllFalse(D(), small)) return closed;
  const Coefficients series = Coefficients::by_series(u);
  Coefficients result;
  for (std::size_t k = 0; k < Coefficients::kCount; ++k)
    result.values[k] = hn::IfThenElse(small, series.values[k], closed.values[k]);
  return result;
}

/// The coefficients of J_l^-1 = half_cot I - phi^/2 + D phi phi^T, and their slopes in u.
struct InverseCoefficients {
  enum : std::size_t { kHalfCot, kD, kHalfCotSlope, kDSlope, kCount };
  V values[kCount];

  static HWY_INLINE InverseCoefficients by_series(V u) {
    const auto& series = small_angle::detail::cotangent_series<double>();
    const V d = polynomial(series.d, u);
    const V slope = polynomial(series.slope, u);
    return {{hn::NegMulAdd(u, d, set(1.0)), d, hn::Neg(hn::MulAdd(u, slope, d)), slope}};
  }
  static HWY_INLINE InverseCoefficients in_closed_form(V u) {
    const Half half(u);
    const V half_cot = hn::Div(half.cosine, half.sinc);
    const V inverse = hn::Div(set(1.0), u);
    const V d = hn::Mul(hn::Sub(set(1.0), half_cot), inverse);
    const V rational = hn::NegMulAdd(half_cot, half_cot, hn::NegMulAdd(set(0.25), u, half_cot));
    const V slope = hn::Mul(rational, hn::Mul(set(0.5), inverse));
    return {{half_cot, d, slope, hn::Neg(hn::Mul(hn::Add(slope, d), inverse))}};
  }
};

/// J_l^-1.
HWY_INLINE TwistMatrices left_jacobian_inverse(const Tangents& xi) {
  const auto& [phi, rho] = xi;
  using C = InverseCoefficients;
  const C found = coefficients<C>(dot(phi, phi));
  const V* const c = found.values;
  const V along = dot(phi, rho);
  const V3 half = scaled(hn::Mul(set(0.5), c[C::kD]), phi);
  return {hat_plus_symmetric(c[C::kHalfCot], scaled(set(-0.5), phi), phi, half),
          hat_plus_symmetric(
              hn::Mul(hn::Add(along, along), c[C::kHalfCotSlope]), scaled(set(-0.5), rho), phi,
              scaled_sum(hn::Mul(along, c[C::kDSlope]), phi, scaled(c[C::kD], rho)))};
}

/// The coefficients of J_l = A I + B phi^ + C phi phi^T, and their slopes in u.
struct JacobianCoefficients {
  enum : std::size_t { kA, kB, kC, kBSlope, kCSlope, kCount };
  V values[kCount];

  HWY_INLINE V a_slope() const { return hn::Mul(set(0.5), hn::Sub(values[kC], values[kB])); }

  static HWY_INLINE JacobianCoefficients by_series(V u) {
    const auto& series = small_angle::detail::sine_series<double>();
    const V c = polynomial(series.c, u);
    return {{hn::NegMulAdd(u, c, set(1.0)), polynomial(series.b, u), c, polynomial(series.d_b, u),
             polynomial(series.d_c, u)}};
  }
  static HWY_INLINE JacobianCoefficients in_closed_form(V u) {
    const Half half(u);
    const V inverse = hn::Div(set(1.0), u);
    const V a = hn::Mul(half.sinc, half.cosine);
    const V b = hn::Mul(set(0.5), hn::Mul(half.sinc, half.sinc));
    const V c = hn::Mul(hn::Sub(set(1.0), a), inverse);
    const V half_inverse = hn::Mul(set(0.5), inverse);
    return {{a, b, c, hn::Mul(hn::NegMulAdd(set(2.0), b, a), half_inverse),
             hn::Mul(hn::NegMulAdd(set(3.0), c, b), half_inverse)}};
  }
};

/// J_l.
HWY_INLINE TwistMatrices left_jacobian(const Tangents& xi) {
  const auto& [phi, rho] = xi;
  using C = JacobianCoefficients;
  const C found = coefficients<C>(dot(phi, phi));
  const V* const c = found.values;
  const V along = dot(phi, rho);
  const V du = hn::Add(along, along);
  const V3 half = scaled(hn::Mul(set(0.5), c[C::kC]), phi);
  return {
      hat_plus_symmetric(c[C::kA], scaled(c[C::kB], phi), phi, half),
      hat_plus_symmetric(hn::Mul(du, found.a_slope()),
                         scaled_sum(hn::Mul(du, c[C::kBSlope]), phi, scaled(c[C::kB], rho)), phi,
                         scaled_sum(hn::Mul(along, c[C::kCSlope]), phi, scaled(c[C::kC], rho)))};
}

/// R(q) by columns.
HWY_INLINE Matrices matrices(const Quaternion& q) {
  const V3 twice = scaled(set(2.0), q.v);
  const V one = set(1.0);
  const V xx = hn::Mul(twice.x, q.v.x), yy = hn::Mul(twice.y, q.v.y), zz = hn::Mul(twice.z, q.v.z);
  const V xy = hn::Mul(twice.x, q.v.y), xz = hn::Mul(twice.x, q.v.z), yz = hn::Mul(twice.y, q.v.z);
  const V wx = hn::Mul(twice.x, q.w), wy = hn::Mul(twice.y, q.w), wz = hn::Mul(twice.z, q.w);
  return {{hn::Sub(one, hn::Add(yy, zz)), hn::Add(xy, wz), hn::Sub(xz, wy),  //
           hn::Sub(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Add(yz, wx),  //
           hn::Add(xz, wy), hn::Sub(yz, wx), hn::Sub(one, hn::Add(xx, yy))}};
}

/// Ad = [R 0; t^ R R].
HWY_INLINE TwistMatrices adjoint(const Poses& x) {
  TwistMatrices result{matrices(x.rotation), {}};
  for (std::size_t column = 0; column < 9; column += 3) {
    const V* const r = result.a.m + column;
    const V3 turned = cross(x.translation, {r[0], r[1], r[2]});
    result.b.m[column] = turned.x;
    result.b.m[column + 1] = turned.y;
    result.b.m[column + 2] = turned.z;
  }
  return result;
}

/// M xi.
HWY_INLINE V3 times(const Matrices& a, const V3& x) {
  const V* const m = a.m;
  return {hn::MulAdd(m[0], x.x, hn::MulAdd(m[3], x.y, hn::Mul(m[6], x.z))),
          hn::MulAdd(m[1], x.x, hn::MulAdd(m[4], x.y, hn::Mul(m[7], x.z))),
          hn::MulAdd(m[2], x.x, hn::MulAdd(m[5], x.y, hn::Mul(m[8], x.z)))};
}
HWY_INLINE V3 sum(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Tangents times(const TwistMatrices& m, const Tangents& xi) {
  return {times(m.a, xi.phi), sum(times(m.b, xi.phi), times(m.a, xi.rho))};
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
