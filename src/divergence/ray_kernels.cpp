// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "divergence/ray_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ray_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "divergence/density_kernels-inl.hpp"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"
#include "mixture/em_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

HWY_INLINE PeakValue peak_value(const RayPeak& peak, V cosine, V sine) {
  const V scalar = hn::MulAdd(cosine, set(peak.a_scalar), hn::Mul(sine, set(peak.b_scalar)));
  V squared = hn::Zero(D());
  for (int i = 0; i < 3; ++i) {
    const V white = hn::MulAdd(cosine, set(peak.white_a[i]), hn::Mul(sine, set(peak.white_b[i])));
    squared = hn::MulAdd(white, white, squared);
  }
  return peak_value(scalar, squared, peak.log_scale);
}

HWY_INLINE V mixture_log_density(const RayPeak* peaks, std::size_t count, V cosine, V sine,
                                 double* scratch) {
  for (std::size_t j = 0; j < count; ++j)
    store_value(peak_value(peaks[j], cosine, sine), scratch, j, kRayPoints);
  return log_of_sum(scratch, count, kRayPoints);
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
