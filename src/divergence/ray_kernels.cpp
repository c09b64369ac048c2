// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "divergence/ray_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ray_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"
#include "lie/half_angle-inl.hpp"
#include "mixture/em_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// k^2 = 1 / |det J_l| = (theta / (2 sin(theta/2)))^2, and the exponent of the density, with
/// |L^-1 xi|^2 = 4 k^2 |L^-1 v|^2 for the vector part v of the quaternion.
struct PeakValue {
  V gain;
  V exponent;
};

HWY_INLINE PeakValue peak_value(const RayPeak& peak, V cosine, V sine) {
  const V scalar = hn::MulAdd(cosine, set(peak.a_scalar), hn::Mul(sine, set(peak.b_scalar)));
  // Rounding may leave the cosine a little above one.
  const V ratio = Powers(hn::Min(hn::Abs(scalar), set(1.0))).polynomial(kHalfAngleOverSine);
  V squared = hn::Zero(D());
  for (int i = 0; i < 3; ++i) {
    const V white = hn::MulAdd(cosine, set(peak.white_a[i]), hn::Mul(sine, set(peak.white_b[i])));
    squared = hn::MulAdd(white, white, squared);
  }
  const V gain = hn::Mul(ratio, ratio);
  return {gain, hn::NegMulAdd(hn::Mul(set(2.0), gain), squared, set(peak.log_scale))};
}

/// log sum_j k_j^2 exp(e_j).
HWY_INLINE V mixture_log_density(const RayPeak* peaks, std::size_t count, V cosine, V sine,
                                 double* scratch) {
  if (count == 1) {
    const PeakValue one = peak_value(peaks[0], cosine, sine);
    return hn::Add(one.exponent, hn::Log(D(), one.gain));
  }
  V largest = hn::Neg(hn::Inf(D()));
  for (std::size_t j = 0; j < count; ++j) {
    const PeakValue value = peak_value(peaks[j], cosine, sine);
    hn::StoreU(value.gain, D(), scratch + 2 * j * kRayPoints);
    hn::StoreU(value.exponent, D(), scratch + (2 * j + 1) * kRayPoints);
    largest = hn::Max(largest, value.exponent);
  }
  V sum = hn::Zero(D());
  for (std::size_t j = 0; j < count; ++j) {
    const V gain = hn::LoadU(D(), scratch + 2 * j * kRayPoints);
    const V exponent = hn::LoadU(D(), scratch + (2 * j + 1) * kRayPoints);
    sum = hn::MulAdd(gain, hn::Exp(D(), hn::Sub(exponent, largest)), sum);
  }
  return hn::Add(largest, hn::Log(D(), sum));
}

void ray_log_densities(const RayPeak* peaks, std::size_t of_p, std::size_t count, double stretch,
                       RayBlock& block, double* scratch) {
  const V half_stretch = set(0.5 * stretch);
  for (std::size_t i = 0; i < kRayPoints; i += hn::Lanes(D())) {
    const V rho = load(block.rho + i);
    const V half = hn::Mul(half_stretch, rho);
    const V cosine = hn::Cos(D(), half);
    const V sine = hn::Sin(D(), half);
    const V squared = hn::Mul(rho, rho);
    hn::Store(hn::Mul(squared, hn::Exp(D(), hn::Mul(set(-0.5), squared))), D(), block.mass + i);
    hn::Store(mixture_log_density(peaks, of_p, cosine, sine, scratch), D(), block.log_p + i);
    hn::Store(mixture_log_density(peaks + of_p, count - of_p, cosine, sine, scratch), D(),
              block.log_q + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(ray_log_densities);

void ray_log_densities(const RayPeak* peaks, std::size_t of_p, std::size_t count, double stretch,
                       RayBlock& block, double* scratch) {
  POSEMIX_DISPATCH(ray_log_densities)(peaks, of_p, count, stretch, block, scratch);
}

}  // namespace posemix::internal
#endif
