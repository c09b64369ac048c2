// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// The coefficients of Exp and of the Jacobians, at most eight angles at a time. Included once for
// every set of vector instructions.
#if defined(POSEMIX_ANGLE_COEFFICIENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_ANGLE_COEFFICIENTS_INL
#undef POSEMIX_ANGLE_COEFFICIENTS_INL
#else
#define POSEMIX_ANGLE_COEFFICIENTS_INL
#endif

#include <array>
#include <cstddef>

#include "base/vectors-inl.hpp"
#include "hwy/highway.h"
#include "lie/jacobian_polynomials.hpp"
#include "lie/large_angles.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

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

/// Whether all squared angles are such that the polynomials hold; none is that is not a number.
HWY_INLINE bool polynomials_hold(V u) {
  return hn::AllTrue(D(), hn::Lt(u, set(kLargestSquaredAngle)));
}

/// In lanes for which the polynomials do not hold, what `of_angle` makes of the squared angle.
template <std::size_t kCount>
HWY_NOINLINE void replace_beyond_polynomials(V u, void (*of_angle)(double, double*), V* values) {
  HWY_ALIGN double squared[kLanes];
  HWY_ALIGN double lanes[kCount][kLanes];
  hn::Store(u, D(), squared);
  for (std::size_t k = 0; k < kCount; ++k) hn::Store(values[k], D(), lanes[k]);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (squared[lane] < kLargestSquaredAngle) continue;
    double one[kCount];
    of_angle(squared[lane], one);
    for (std::size_t k = 0; k < kCount; ++k) lanes[k][lane] = one[k];
  }
  for (std::size_t k = 0; k < kCount; ++k) values[k] = hn::Load(D(), lanes[k]);
}

/// Coefficients for any angle. Those of the polynomials are copied where some are replaced, so that
/// they are registers otherwise.
template <class Coefficients>
HWY_INLINE Coefficients coefficients(V u) {
  Coefficients found = Coefficients::by_polynomials(u);
  if (HWY_UNLIKELY(!polynomials_hold(u))) {
    V copy[Coefficients::kCount];
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < Coefficients::kCount; ++k) copy[k] = found.values[k];
    replace_beyond_polynomials<Coefficients::kCount>(u, &Coefficients::of_angle, copy);
    POSEMIX_UNROLL
    for (std::size_t k = 0; k < Coefficients::kCount; ++k) found.values[k] = copy[k];
  }
  return found;
}

/// cos and sinc of half the angle.
struct HalfAngle {
  enum : std::size_t { kCosine, kSinc, kCount };
  V values[kCount];

  static void of_angle(double u, double* one) { half_angle_coefficients(u, one); }
  static HWY_INLINE HalfAngle by_polynomials(V u) {
    return {{polynomial(kCosineOfHalf, u), polynomial(kSincOfHalf, u)}};
  }
};

/// The coefficients of J_l^-1 = half_cot I - phi^/2 + D phi phi^T.
struct InverseCoefficients {
  enum : std::size_t { kHalfCot, kD, kCount };
  V values[kCount];

  static void of_angle(double u, double* one) { inverse_jacobian_coefficients(u, one); }
  static HWY_INLINE InverseCoefficients by_polynomials(V u) {
    const V pole = hn::Div(set(2.0), hn::Sub(set(kPole), u));
    const V d = hn::Add(pole, polynomial(kInverseRest, u));
    return {{hn::NegMulAdd(u, d, set(1.0)), d}};
  }
};

/// The same and their slopes in u.
struct InverseCoefficientsAndSlopes {
  enum : std::size_t { kHalfCot, kD, kHalfCotSlope, kDSlope, kCount };
  V values[kCount];

  static void of_angle(double u, double* one) { inverse_jacobian_coefficients_and_slopes(u, one); }
  static HWY_INLINE InverseCoefficientsAndSlopes by_polynomials(V u) {
    const V pole = hn::Div(set(2.0), hn::Sub(set(kPole), u));
    const V d = hn::Add(pole, polynomial(kInverseRest, u));
    const V slope = hn::MulAdd(pole, hn::Mul(set(0.5), pole), polynomial(kInverseSlopeRest, u));
    return {{hn::NegMulAdd(u, d, set(1.0)), d, hn::Neg(hn::MulAdd(u, slope, d)), slope}};
  }
};

/// The coefficients of J_l = A I + B phi^ + C phi phi^T. C' = (B - 3 C) / (2 u) gives B.
struct JacobianCoefficients {
  enum : std::size_t { kA, kB, kC, kCount };
  V values[kCount];

  static void of_angle(double u, double* one) { jacobian_coefficients(u, one); }
  static HWY_INLINE JacobianCoefficients by_polynomials(V u) {
    const V c = polynomial(kSecondOrder, u);
    const V slope = polynomial(kSecondOrderSlope, u);
    return {
        {hn::NegMulAdd(u, c, set(1.0)), hn::MulAdd(hn::Add(u, u), slope, hn::Mul(set(3.0), c)), c}};
  }
};

/// The same and the slopes of B and C in u; that of A is (C - B) / 2.
struct JacobianCoefficientsAndSlopes {
  enum : std::size_t { kA, kB, kC, kBSlope, kCSlope, kCount };
  V values[kCount];

  static void of_angle(double u, double* one) { jacobian_coefficients_and_slopes(u, one); }
  static HWY_INLINE JacobianCoefficientsAndSlopes by_polynomials(V u) {
    const V c = polynomial(kSecondOrder, u);
    const V slope = polynomial(kSecondOrderSlope, u);
    return {{hn::NegMulAdd(u, c, set(1.0)), hn::MulAdd(hn::Add(u, u), slope, hn::Mul(set(3.0), c)),
             c, polynomial(kFirstOrderSlope, u), slope}};
  }
  HWY_INLINE V a_slope() const { return hn::Mul(set(0.5), hn::Sub(values[kC], values[kB])); }
};

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
