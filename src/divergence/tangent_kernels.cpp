// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "divergence/tangent_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tangent_kernels.cpp"
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

/// (-1)^k / (2 k + odd)! for the series of cos(sqrt(u)) and of sin(sqrt(u)) / sqrt(u) in u: exact
/// to 1e-17 up to u = (pi/2)^2. Neither needs a root, a division, or care about zero.
struct Alternating {
  static constexpr int kTerms = 13;
  double c[kTerms];

  explicit constexpr Alternating(int odd) : c{1.0} {
    for (int k = 1; k < kTerms; ++k) c[k] = -c[k - 1] / ((2.0 * k + odd) * (2.0 * k + odd - 1.0));
  }
};
constexpr Alternating kCosine(0);
constexpr Alternating kSineRatio(1);

HWY_INLINE V sum_of(const Alternating& series, V u) {
  V sum = set(series.c[Alternating::kTerms - 1]);
  POSEMIX_UNROLL
  for (int k = Alternating::kTerms - 2; k >= 0; --k) sum = hn::MulAdd(sum, u, set(series.c[k]));
  return sum;
}

/// cos(t/2) and x sin(t/2) / t of all points.
struct alignas(64) TangentPoints {
  double part[4][kTangentPoints];
};

HWY_INLINE void place_points(const double (&variances)[3], TangentBlock& block,
                             TangentPoints& points) {
  for (std::size_t i = 0; i < kTangentPoints; i += hn::Lanes(D())) {
    const V3 x{load(block.x[0] + i), load(block.x[1] + i), load(block.x[2] + i)};
    const V3 squares{hn::Mul(x.x, x.x), hn::Mul(x.y, x.y), hn::Mul(x.z, x.z)};
    const V squared = hn::Add(squares.x, hn::Add(squares.y, squares.z));
    hn::Store(squared, D(), block.squared + i);
    hn::Store(hn::Exp(D(), hn::Mul(set(-0.5), squared)), D(), block.mass + i);
    const V u = hn::Mul(set(0.25), dot(squares, set3(variances)));
    const V3 sine = scaled(hn::Mul(set(0.5), sum_of(kSineRatio, u)), x);
    hn::Store(sum_of(kCosine, u), D(), points.part[0] + i);
    hn::Store(sine.x, D(), points.part[1] + i);
    hn::Store(sine.y, D(), points.part[2] + i);
    hn::Store(sine.z, D(), points.part[3] + i);
  }
}

HWY_INLINE V times(const double (&row)[4], const V (&part)[4]) {
  const V low = hn::MulAdd(part[0], set(row[0]), hn::Mul(part[1], set(row[1])));
  return hn::MulAdd(part[2], set(row[2]), hn::MulAdd(part[3], set(row[3]), low));
}

/// The values of one peak at all points.
HWY_INLINE void store_values(const TangentPeak& peak, const TangentPoints& points, double* values,
                             std::size_t j) {
  for (std::size_t i = 0; i < kTangentPoints; i += hn::Lanes(D())) {
    const V part[4] = {load(points.part[0] + i), load(points.part[1] + i), load(points.part[2] + i),
                       load(points.part[3] + i)};
    V squared = hn::Zero(D());
    for (const auto& row : peak.white) {
      const V white = times(row, part);
      squared = hn::MulAdd(white, white, squared);
    }
    const V scalar = times(peak.scalar, part);
    store_value(peak_value(scalar, squared, peak.log_scale), values + i, j, kTangentPoints);
  }
}

/// Short loops one after another, so that the processor works at several vectors at once: a log
/// density is one long chain.
void tangent_log_densities(const TangentView& view, TangentBlock& block, double* scratch) {
  TangentPoints points;
  place_points(view.variances, block, points);
  for (std::size_t j = 0; j < view.count; ++j) store_values(view.peaks[j], points, scratch, j);
  const double* of_q = scratch + 2 * kTangentPoints * view.of_p;
  for (std::size_t i = 0; i < kTangentPoints; i += hn::Lanes(D()))
    hn::Store(log_of_sum(scratch + i, view.of_p, kTangentPoints), D(), block.log_p + i);
  for (std::size_t i = 0; i < kTangentPoints; i += hn::Lanes(D())) {
    const V log_q = log_of_sum(of_q + i, view.count - view.of_p, kTangentPoints);
    hn::Store(log_q, D(), block.log_q + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(tangent_log_densities);

void tangent_log_densities(const TangentView& view, TangentBlock& block, double* scratch) {
  POSEMIX_DISPATCH(tangent_log_densities)(view, block, scratch);
}

}  // namespace posemix::internal
#endif
