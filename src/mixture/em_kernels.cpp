// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "em_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "em_moments-inl.hpp"
#include "em_pose-inl.hpp"
#include "em_rn-inl.hpp"
#include "em_vector-inl.hpp"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

template <int kN>
void projected_rows(const EmRow* samples, std::size_t count, const ProjectedKernel& density,
                    EmRow* y, EmRow& out) {
  const Quaternion inverse{{set(-density.tangent_point[0]), set(-density.tangent_point[1]),
                            set(-density.tangent_point[2])},
                           set(density.tangent_point[3])};
  const V infinity = hn::Inf(D());
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const Quaternion r = product(inverse, load_rotation(samples, i));
    const V scale = hn::Div(set(1.0), r.w);
    V v[kN];
    v[0] = hn::MulSub(r.v.x, scale, set(density.u[0]));
    v[1] = hn::MulSub(r.v.y, scale, set(density.u[1]));
    v[2] = hn::MulSub(r.v.z, scale, set(density.u[2]));
    if constexpr (kN == 6) {
      for (std::size_t j = 0; j < 3; ++j)
        v[3 + j] = hn::Sub(load(samples[4 + j], i), set(density.translation[j]));
    }
    const V squared = squared_norm<kN>(density.factor, v);
    const auto inside = hn::Lt(squared, infinity);
    for (int j = 0; j < kN; ++j) store(hn::IfThenElseZero(inside, v[j]), y[j], i);
    const V log = hn::NegMulAdd(set(0.5), squared, set(density.log_constant));
    store(hn::IfThenElse(inside, log, hn::Neg(infinity)), out, i);
  }
}

void projected_log_density(const EmRow* samples, std::size_t count, const ProjectedKernel& density,
                           EmRow* y, EmRow& out) {
  density.dimensions == 3 ? projected_rows<3>(samples, count, density, y, out)
                          : projected_rows<6>(samples, count, density, y, out);
}

void add_moments(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                 double* sums) {
  const StoredRows rows{y};
  n == 3 ? add_moments_of<3>(rows, shares, count, sums)
         : add_moments_of<6>(rows, shares, count, sums);
}

template <int kN>
void projected_gradient(const EmRow* y, const EmRow& shares, std::size_t count,
                        const ProjectedKernel& density, double* sums) {
  V total[4];
  for (std::size_t j = 0; j < 4; ++j) total[j] = load_sum(sums, j);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V share = load(shares, i);
    if (none(share)) continue;
    V v[kN];
    for (int j = 0; j < kN; ++j) v[j] = load(y[j], i);
    V inner = hn::Mul(v[0], row_times(density.precision_u[0], v, kN));
    inner = hn::MulAdd(v[1], row_times(density.precision_u[1], v, kN), inner);
    inner = hn::MulAdd(v[2], row_times(density.precision_u[2], v, kN), inner);
    inner = hn::Mul(share, inner);
    for (int j = 0; j < 3; ++j) total[j] = hn::MulAdd(inner, v[j], total[j]);
    total[3] = hn::MulAdd(inner, dot({v[0], v[1], v[2]}, {v[0], v[1], v[2]}), total[3]);
  }
  for (std::size_t j = 0; j < 4; ++j) store_sum(total[j], sums, j);
}

void add_projected_gradient(const EmRow* y, const EmRow& shares, std::size_t count,
                            const ProjectedKernel& density, double* sums) {
  density.dimensions == 3 ? projected_gradient<3>(y, shares, count, density, sums)
                          : projected_gradient<6>(y, shares, count, density, sums);
}

/// exp(x) for x in [-700, 0]: 2^n exp(r), |r| <= ln 2 / 2, and the Taylor series to r^13.
HWY_INLINE V exp_of_negative(V x) {
  const hn::RebindToUnsigned<D> bits;
  // The sum of a small number and `shift` ends in the nearest integer of that number.
  const V shift = set(0x1.8p52);
  const V shifted = hn::MulAdd(x, set(1.4426950408889634), shift);
  const V n = hn::Sub(shifted, shift);
  const V r =
      hn::NegMulAdd(n, set(0x1.abc9e3b39803fp-56), hn::NegMulAdd(n, set(0x1.62e42fefa39efp-1), x));
  const V r2 = hn::Mul(r, r);
  const V r4 = hn::Mul(r2, r2);
  const auto pair = [&](double c0, double c1) HWY_ATTR { return hn::MulAdd(r, set(c1), set(c0)); };
  const V c01 = pair(1.0, 1.0);
  const V c23 = pair(1.0 / 2, 1.0 / 6);
  const V c45 = pair(1.0 / 24, 1.0 / 120);
  const V c67 = pair(1.0 / 720, 1.0 / 5040);
  const V c89 = pair(1.0 / 40320, 1.0 / 362880);
  const V c1011 = pair(1.0 / 3628800, 1.0 / 39916800);
  const V c1213 = pair(1.0 / 479001600, 1.0 / 6227020800);
  const V high =
      hn::MulAdd(hn::MulAdd(c1213, r4, hn::MulAdd(c1011, r2, c89)), r4, hn::MulAdd(c67, r2, c45));
  const V sum = hn::MulAdd(high, r4, hn::MulAdd(c23, r2, c01));
  return hn::BitCast(
      D(), hn::Add(hn::BitCast(bits, sum), hn::ShiftLeft<52>(hn::BitCast(bits, shifted))));
}

/// Log of a share of 1e-30: what is less does not count.
constexpr double kLeastLog = -69.0;

double shares_of_log_terms(const EmRow& weights, std::size_t count, EmRow* terms,
                           std::size_t components) {
  const V zero = hn::Zero(D());
  V log_likelihood = zero;
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    V largest = set(-1e308);
    for (std::size_t k = 0; k < components; ++k) largest = hn::Max(largest, load(terms[k], i));
    V sum = zero;
    for (std::size_t k = 0; k < components; ++k) {
      const V log = hn::Sub(load(terms[k], i), largest);
      const auto counts = hn::Gt(log, set(kLeastLog));
      V part = zero;
      if (!hn::AllFalse(D(), counts)) part = hn::IfThenElseZero(counts, exp_of_negative(log));
      sum = hn::Add(sum, part);
      store(part, terms[k], i);
    }
    const V weight = load(weights, i);
    const V scale = hn::IfThenElseZero(hn::Gt(sum, zero), hn::Div(weight, sum));
    for (std::size_t k = 0; k < components; ++k)
      store(hn::Mul(scale, load(terms[k], i)), terms[k], i);
    const V log = hn::IfThenElse(hn::Gt(sum, zero), hn::Add(largest, hn::Log(D(), sum)),
                                 hn::Neg(hn::Inf(D())));
    log_likelihood =
        hn::Add(log_likelihood, hn::IfThenElseZero(hn::Gt(weight, zero), hn::Mul(weight, log)));
  }
  return hn::GetLane(hn::SumOfLanes(D(), log_likelihood));
}

void log_sums_of(const double* log_weights, std::size_t components, const EmRow* terms,
                 std::size_t count, EmRow& out) {
  const V zero = hn::Zero(D());
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    V largest = set(-1e308);
    // A NaN stays one; comparisons alone would take its exponential for zero.
    auto is_nan = hn::IsNaN(zero);
    for (std::size_t k = 0; k < components; ++k) {
      const V term = hn::Add(set(log_weights[k]), load(terms[k], i));
      is_nan = hn::Or(is_nan, hn::IsNaN(term));
      largest = hn::Max(largest, term);
    }
    V sum = zero;
    for (std::size_t k = 0; k < components; ++k) {
      const V log = hn::Sub(hn::Add(set(log_weights[k]), load(terms[k], i)), largest);
      const auto counts = hn::Gt(log, set(kLeastLog));
      if (!hn::AllFalse(D(), counts))
        sum = hn::Add(sum, hn::IfThenElseZero(counts, exp_of_negative(log)));
    }
    const V log = hn::Add(largest, hn::Log(D(), sum));
    const V of_numbers = hn::IfThenElse(hn::Gt(sum, zero), log, hn::Neg(hn::Inf(D())));
    store(hn::IfThenElse(is_nan, hn::NaN(D()), of_numbers), out, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(projected_log_density);
HWY_EXPORT(add_moments);
HWY_EXPORT(add_projected_gradient);
HWY_EXPORT(pose_log_density);
HWY_EXPORT(add_pose_gradient);
HWY_EXPORT(rn_log_density);
HWY_EXPORT(add_rn_moments);
HWY_EXPORT(shares_of_log_terms);
HWY_EXPORT(log_sums_of);
HWY_EXPORT(rotation_log_density);

void projected_log_density(const EmRow* samples, std::size_t count, const ProjectedKernel& density,
                           EmRow* y, EmRow& out) {
  POSEMIX_DISPATCH(projected_log_density)(samples, count, density, y, out);
}

void add_moments(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                 double* sums) {
  POSEMIX_DISPATCH(add_moments)(n, y, shares, count, sums);
}

void add_projected_gradient(const EmRow* y, const EmRow& shares, std::size_t count,
                            const ProjectedKernel& density, double* sums) {
  POSEMIX_DISPATCH(add_projected_gradient)(y, shares, count, density, sums);
}

void rotation_log_density(const EmRow* samples, std::size_t count, const RotationKernel& density,
                          EmRow& out) {
  POSEMIX_DISPATCH(rotation_log_density)(samples, count, density, out);
}

void pose_log_density(const EmRow* samples, std::size_t count, const PoseKernel& density,
                      EmRow* rows, EmRow& out) {
  POSEMIX_DISPATCH(pose_log_density)(samples, count, density, rows, out);
}

void add_pose_gradient(const EmRow* rows, const EmRow& shares, std::size_t count,
                       const PoseKernel& density, double* sums) {
  POSEMIX_DISPATCH(add_pose_gradient)(rows, shares, count, density, sums);
}

void rn_log_density(const EmRow* samples, std::size_t count, const RnKernel& density, EmRow& out) {
  POSEMIX_DISPATCH(rn_log_density)(samples, count, density, out);
}

void add_rn_moments(const EmRow* samples, const EmRow& shares, std::size_t count,
                    const RnKernel& density, double* sums) {
  POSEMIX_DISPATCH(add_rn_moments)(samples, shares, count, density, sums);
}

double shares_from_log_terms(const EmRow& weights, std::size_t count, std::span<EmRow> terms) {
  return POSEMIX_DISPATCH(shares_of_log_terms)(weights, count, terms.data(), terms.size());
}

void log_sums(std::span<const double> log_weights, std::size_t count, std::span<const EmRow> terms,
              EmRow& out) {
  POSEMIX_DISPATCH(log_sums_of)(log_weights.data(), terms.size(), terms.data(), count, out);
}

}  // namespace posemix::internal
#endif
