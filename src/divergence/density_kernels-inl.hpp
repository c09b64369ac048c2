// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Log densities of mixtures on SO(3), at most eight points at a time. Included once for every set
// of vector instructions.
#if defined(POSEMIX_DENSITY_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_DENSITY_KERNELS_INL
#undef POSEMIX_DENSITY_KERNELS_INL
#else
#define POSEMIX_DENSITY_KERNELS_INL
#endif

#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"
#include "lie/half_angle-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// k^2 = 1 / |det J_l| = (theta / (2 sin(theta/2)))^2, and the exponent of the density.
struct PeakValue {
  V gain;
  V exponent;
};

/// The value from the scalar part of the quaternion of X mean^-1 and from |L^-1 v|^2 for its vector
/// part v, with |L^-1 xi|^2 = 4 k^2 |L^-1 v|^2.
HWY_INLINE PeakValue peak_value(V scalar, V white_squared, double log_scale) {
  // Rounding may leave the cosine a little above one.
  const V ratio = Powers(hn::Min(hn::Abs(scalar), set(1.0))).polynomial(kHalfAngleOverSine);
  const V gain = hn::Mul(ratio, ratio);
  return {gain, hn::NegMulAdd(hn::Mul(set(2.0), gain), white_squared, set(log_scale))};
}

/// log sum_j k_j^2 exp(e_j), with k_j^2 at values + 2 j stride and e_j behind it by a stride.
HWY_INLINE V log_of_sum(const double* values, std::size_t count, std::size_t stride) {
  const auto gain = [=](std::size_t j) HWY_ATTR { return hn::LoadU(D(), values + 2 * j * stride); };
  const auto exponent = [=](std::size_t j)
                            HWY_ATTR { return hn::LoadU(D(), values + (2 * j + 1) * stride); };
  if (count == 1) return hn::Add(exponent(0), hn::Log(D(), gain(0)));
  if (count == 2) {
    // One exponential is that of zero.
    const V largest = hn::Max(exponent(0), exponent(1));
    const V smaller = hn::Exp(D(), hn::Sub(hn::Min(exponent(0), exponent(1)), largest));
    const auto first_is_larger = hn::Ge(exponent(0), exponent(1));
    const V first = hn::Mul(gain(0), hn::IfThenElse(first_is_larger, set(1.0), smaller));
    const V second = hn::IfThenElse(first_is_larger, smaller, set(1.0));
    return hn::Add(largest, hn::Log(D(), hn::MulAdd(gain(1), second, first)));
  }
  V largest = exponent(0);
  for (std::size_t j = 1; j < count; ++j) largest = hn::Max(largest, exponent(j));
  V sum = hn::Zero(D());
  for (std::size_t j = 0; j < count; ++j)
    sum = hn::MulAdd(gain(j), hn::Exp(D(), hn::Sub(exponent(j), largest)), sum);
  return hn::Add(largest, hn::Log(D(), sum));
}

HWY_INLINE void store_value(const PeakValue& value, double* values, std::size_t j,
                            std::size_t stride) {
  hn::StoreU(value.gain, D(), values + 2 * j * stride);
  hn::StoreU(value.exponent, D(), values + (2 * j + 1) * stride);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
