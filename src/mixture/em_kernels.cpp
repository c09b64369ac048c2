// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em_kernels.hpp"

#include "em_polynomials.hpp"

// Two widths besides what every machine has, and none whose vectors cannot be members.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "em_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr std::size_t kSumStride = 8;

HWY_INLINE V load(const double* at) { return hn::Load(D(), at); }
HWY_INLINE V load(const EmRow& row, std::size_t i) { return hn::Load(D(), row.data() + i); }
HWY_INLINE void store(V v, EmRow& row, std::size_t i) { hn::Store(v, D(), row.data() + i); }
HWY_INLINE V set(double value) { return hn::Set(D(), value); }

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 load3(const EmRow* rows, std::size_t i) {
  return {load(rows[0], i), load(rows[1], i), load(rows[2], i)};
}
HWY_INLINE V3 set3(const double* v) { return {set(v[0]), set(v[1]), set(v[2])}; }
HWY_INLINE void store3(const V3& v, EmRow* rows, std::size_t i) {
  store(v.x, rows[0], i);
  store(v.y, rows[1], i);
  store(v.z, rows[2], i);
}
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
/// s a - b.
HWY_INLINE V3 scaled_difference(V s, const V3& a, const V3& b) {
  return {hn::MulSub(s, a.x, b.x), hn::MulSub(s, a.y, b.y), hn::MulSub(s, a.z, b.z)};
}
/// s a + b.
HWY_INLINE V3 scaled_sum(V s, const V3& a, const V3& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
HWY_INLINE V3 scaled(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}

struct Quaternion {
  V3 v;
  V w;
};

HWY_INLINE Quaternion load_rotation(const EmRow* samples, std::size_t i) {
  return {load3(samples, i), load(samples[3], i)};
}
HWY_INLINE Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {scaled_sum(a.w, b.v, scaled_sum(b.w, a.v, cross(a.v, b.v))),
          hn::MulSub(a.w, b.w, dot(a.v, b.v))};
}

/// Powers of z = 2 c - 1 for the polynomials in it.
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

/// sum_j matrix_ij y_j over j in [0, columns).
HWY_INLINE V row_times(const std::array<double, 6>& row, const V* y, int columns) {
  V sum = hn::Mul(set(row[0]), y[0]);
  for (int j = 1; j < columns; ++j)
    sum = hn::MulAdd(set(row[static_cast<std::size_t>(j)]), y[j], sum);
  return sum;
}

/// |L^-1 y|^2.
template <int kN>
HWY_INLINE V squared_norm(const std::array<std::array<double, 6>, 6>& factor, const V* y) {
  V sum = hn::Zero(D());
  for (int i = 0; i < kN; ++i) {
    const V white = row_times(factor[static_cast<std::size_t>(i)], y, i + 1);
    sum = hn::MulAdd(white, white, sum);
  }
  return sum;
}

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

void projected_log_density(std::size_t n, const EmRow* samples, std::size_t count,
                           const ProjectedKernel& density, EmRow* y, EmRow& out) {
  n == 3 ? projected_rows<3>(samples, count, density, y, out)
         : projected_rows<6>(samples, count, density, y, out);
}

/// Row kRow of the moments: first += s, second_j += s y_j.
template <int kRow>
struct MomentRow {
  V first;
  V second[kRow + 1];

  HWY_INLINE MomentRow(std::size_t n, const double* sums) {
    first = load(sums + (1 + kRow) * kSumStride);
    for (std::size_t j = 0; j <= kRow; ++j)
      second[j] = load(sums + em_second_moment(n, kRow, j) * kSumStride);
  }
  HWY_INLINE void add(const V* y, V share) {
    const V shared = hn::Mul(share, y[kRow]);
    first = hn::Add(first, shared);
    for (int j = 0; j <= kRow; ++j) second[j] = hn::MulAdd(shared, y[j], second[j]);
  }
  HWY_INLINE void save(std::size_t n, double* sums) const {
    hn::Store(first, D(), sums + (1 + kRow) * kSumStride);
    for (std::size_t j = 0; j <= kRow; ++j)
      hn::Store(second[j], D(), sums + em_second_moment(n, kRow, j) * kSumStride);
  }
};

HWY_INLINE bool none(V share) { return hn::AllTrue(D(), hn::Eq(share, hn::Zero(D()))); }

void add_moments_3(const EmRow* y, const EmRow& shares, std::size_t count, double* sums) {
  V weight = load(sums);
  MomentRow<0> row0(3, sums);
  MomentRow<1> row1(3, sums);
  MomentRow<2> row2(3, sums);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V share = load(shares, i);
    if (none(share)) continue;
    const V v[3] = {load(y[0], i), load(y[1], i), load(y[2], i)};
    weight = hn::Add(weight, share);
    row0.add(v, share);
    row1.add(v, share);
    row2.add(v, share);
  }
  hn::Store(weight, D(), sums);
  row0.save(3, sums);
  row1.save(3, sums);
  row2.save(3, sums);
}

void add_moments_6(const EmRow* y, const EmRow& shares, std::size_t count, double* sums) {
  V weight = load(sums);
  MomentRow<0> row0(6, sums);
  MomentRow<1> row1(6, sums);
  MomentRow<2> row2(6, sums);
  MomentRow<3> row3(6, sums);
  MomentRow<4> row4(6, sums);
  MomentRow<5> row5(6, sums);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V share = load(shares, i);
    if (none(share)) continue;
    const V v[6] = {load(y[0], i), load(y[1], i), load(y[2], i),
                    load(y[3], i), load(y[4], i), load(y[5], i)};
    weight = hn::Add(weight, share);
    row0.add(v, share);
    row1.add(v, share);
    row2.add(v, share);
    row3.add(v, share);
    row4.add(v, share);
    row5.add(v, share);
  }
  hn::Store(weight, D(), sums);
  row0.save(6, sums);
  row1.save(6, sums);
  row2.save(6, sums);
  row3.save(6, sums);
  row4.save(6, sums);
  row5.save(6, sums);
}

void add_moments(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                 double* sums) {
  n == 3 ? add_moments_3(y, shares, count, sums) : add_moments_6(y, shares, count, sums);
}

template <int kN>
void projected_gradient(const EmRow* y, const EmRow& shares, std::size_t count,
                        const ProjectedKernel& density, double* sums) {
  V total[4];
  for (std::size_t j = 0; j < 4; ++j) total[j] = load(sums + j * kSumStride);
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
  for (std::size_t j = 0; j < 4; ++j) hn::Store(total[j], D(), sums + j * kSumStride);
}

void add_projected_gradient(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                            const ProjectedKernel& density, double* sums) {
  n == 3 ? projected_gradient<3>(y, shares, count, density, sums)
         : projected_gradient<6>(y, shares, count, density, sums);
}

/// a x b + c.
HWY_INLINE V3 cross_sum(const V3& a, const V3& b, const V3& c) {
  return {hn::MulAdd(a.y, b.z, hn::NegMulAdd(a.z, b.y, c.x)),
          hn::MulAdd(a.z, b.x, hn::NegMulAdd(a.x, b.z, c.y)),
          hn::MulAdd(a.x, b.y, hn::NegMulAdd(a.y, b.x, c.z))};
}

/// Below this squared angle the coefficients of the inverse Jacobian are taken from their series.
constexpr double kSeriesBelow = 1e-2;

/// sum of c[k] u^k, k = 0 ... 4.
HWY_INLINE V series(V u, const double (&c)[5]) {
  const V low = hn::MulAdd(u, set(c[1]), set(c[0]));
  const V high = hn::MulAdd(u, set(c[3]), set(c[2]));
  const V u2 = hn::Mul(u, u);
  return hn::MulAdd(hn::MulAdd(u2, set(c[4]), high), u2, low);
}

/// (1 - (t/2) cot(t/2)) / u, u = t^2, of (t/2) / sin(t/2), cos(t/2) and four times the square of
/// the former. What it loses for small u is lost again where it is multiplied by u.
HWY_INLINE V rest_of(V ratio, V cosine, V four_ratio_squared) {
  const V u = hn::Mul(four_ratio_squared, hn::NegMulAdd(cosine, cosine, set(1.0)));
  const V closed = hn::Div(hn::NegMulAdd(ratio, cosine, set(1.0)), u);
  const V small = series(u, {1.0 / 12, 1.0 / 720, 1.0 / 30240, 1.0 / 1209600, 1.0 / 47900160});
  return hn::IfThenElse(hn::Lt(u, set(kSeriesBelow)), small, closed);
}

/// Twice the derivative of that in u: ((t/2)^2 / sin^2(t/2) + (t/2) cot(t/2) - 2) / u^2.
HWY_INLINE V twice_slope_of(V ratio, V rest, V u) {
  const V rational = hn::NegMulAdd(rest, u, hn::MulSub(ratio, ratio, set(1.0)));
  const V closed = hn::Div(rational, hn::Mul(u, u));
  const V small = series(
      u, {2.0 / 720, 4.0 / 30240, 6.0 / 1209600, 8.0 / 47900160, 10.0 * 691.0 / 1307674368000.0});
  return hn::IfThenElse(hn::Lt(u, set(kSeriesBelow)), small, closed);
}

/// With V(phi)^-1 = I - phi^ / 2 + rest phi^ phi^ and V(phi)^-1 R(phi) = V(-phi)^-1,
///   rho = V(phi)^-1 (t - R t0) = t - t0 + phi x (rest phi x (t - t0) - (t + t0) / 2).
void pose_log_density(const EmRow* samples, std::size_t count, const PoseKernel& density,
                      EmRow* rows, EmRow& out) {
  const Quaternion inverse{
      {set(-density.rotation[0]), set(-density.rotation[1]), set(-density.rotation[2])},
      set(density.rotation[3])};
  const V3 centre = set3(density.translation.data());
  const V3 half_centre = scaled(set(0.5), centre);
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const Quaternion r = product(load_rotation(samples, i), inverse);
    const V cosine = hn::Abs(r.w);
    const Powers powers(cosine);
    const V ratio = powers.polynomial(kHalfAngleOverSine);
    const V log_volume = powers.polynomial(kLogVolume);
    const V twice = hn::Add(ratio, ratio);
    const V3 phi = scaled(hn::Xor(twice, hn::And(r.w, hn::SignBit(D()))), r.v);
    const V rest = rest_of(ratio, cosine, hn::Mul(twice, twice));
    const V3 t = load3(samples + 4, i);
    const V3 d = {hn::Sub(t.x, centre.x), hn::Sub(t.y, centre.y), hn::Sub(t.z, centre.z)};
    const V3 turned = cross(phi, d);
    const V3 g = scaled_difference(rest, turned, scaled_sum(set(0.5), t, half_centre));
    const V3 rho = cross_sum(phi, g, d);
    const V xi[6] = {phi.x, phi.y, phi.z, rho.x, rho.y, rho.z};
    const V squared = squared_norm<6>(density.factor, xi);
    store3(phi, rows, i);
    store3(rho, rows + 3, i);
    store(ratio, rows[kRatio], i);
    store(rest, rows[kRestRow], i);
    store(squared, rows[kSquared], i);
    store(hn::NegMulAdd(set(0.5), squared, hn::Sub(set(density.log_constant), log_volume)), out, i);
  }
}

/// The sums of the part of J_r^-T y that is not linear in second moments. With phi^ phi^ y =
/// phi (phi.y) - phi.phi y and the like, a = share rest, b = 2 share slope phi.rho:
///   first:  phi (a (xi.y - 4) + b phi.y2) + rho (a phi.y2) - a phi.phi y1 - (2 a phi.rho + b
///   phi.phi) y2 last:   phi (a phi.y2) - a phi.phi y2
/// where -4 a phi comes from the volume, and y = P^-1 xi is applied to the sums.
void add_pose_gradient(const EmRow* rows, const EmRow& shares, std::size_t count,
                       const PoseKernel& density, double* sums) {
  V total[kPoseGradientSums];
  for (std::size_t j = 0; j < kPoseGradientSums; ++j) total[j] = load(sums + j * kSumStride);
  const auto& p = density.precision;
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V share = load(shares, i);
    if (none(share)) continue;
    const V3 phi = load3(rows + kXi, i);
    const V3 rho = load3(rows + kXi + 3, i);
    const V xi[6] = {phi.x, phi.y, phi.z, rho.x, rho.y, rho.z};
    const V3 y2 = {row_times(p[3], xi, 6), row_times(p[4], xi, 6), row_times(p[5], xi, 6)};
    const V a = hn::Mul(share, load(rows[kRestRow], i));
    const V phi_rho = dot(phi, rho);
    const V phi_phi = dot(phi, phi);
    const V slope =
        hn::Mul(share, twice_slope_of(load(rows[kRatio], i), load(rows[kRestRow], i), phi_phi));
    const V phi_y2 = dot(phi, y2);
    const V b = hn::Mul(slope, phi_rho);
    const V with_y = hn::Mul(a, phi_phi);
    const V with_y2 = hn::MulAdd(hn::Add(a, a), phi_rho, hn::Mul(b, phi_phi));
    const V along_rho = hn::Mul(a, phi_y2);
    const V along_phi =
        hn::MulAdd(a, hn::Sub(load(rows[kSquared], i), set(4.0)), hn::Mul(b, phi_y2));
    const V3 first = scaled_sum(along_phi, phi, {total[0], total[1], total[2]});
    const V3 both = scaled_sum(along_rho, rho, first);
    const V3 last = scaled_sum(along_rho, phi, {total[3], total[4], total[5]});
    total[0] = both.x, total[1] = both.y, total[2] = both.z;
    total[3] = last.x, total[4] = last.y, total[5] = last.z;
    for (std::size_t j = 0; j < 6; ++j) total[6 + j] = hn::MulAdd(with_y, xi[j], total[6 + j]);
    for (std::size_t j = 0; j < 6; ++j) total[12 + j] = hn::MulAdd(with_y2, xi[j], total[12 + j]);
  }
  for (std::size_t j = 0; j < kPoseGradientSums; ++j)
    hn::Store(total[j], D(), sums + j * kSumStride);
}

/// exp(x) for x in [-700, 0]: 2^n exp(r), |r| <= ln 2 / 2, and the Taylor series to r^13.
HWY_INLINE V exp_of_negative(V x) {
  const hn::RebindToUnsigned<D> bits;
  const V shift = set(0x1.8p52);  // whose sum with a small number ends in its nearest integer
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

double shares_of_log_terms(const EmRow& weights, std::size_t count, EmRow* terms,
                           std::size_t components) {
  constexpr double kLeastLog = -69.0;  // a share of 1e-30
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
HWY_EXPORT(shares_of_log_terms);

void projected_log_density(std::size_t n, const EmRow* samples, std::size_t count,
                           const ProjectedKernel& density, EmRow* y, EmRow& out) {
  HWY_DYNAMIC_DISPATCH(projected_log_density)(n, samples, count, density, y, out);
}

void add_moments(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                 double* sums) {
  HWY_DYNAMIC_DISPATCH(add_moments)(n, y, shares, count, sums);
}

void add_projected_gradient(std::size_t n, const EmRow* y, const EmRow& shares, std::size_t count,
                            const ProjectedKernel& density, double* sums) {
  HWY_DYNAMIC_DISPATCH(add_projected_gradient)(n, y, shares, count, density, sums);
}

void pose_log_density(const EmRow* samples, std::size_t count, const PoseKernel& density,
                      EmRow* rows, EmRow& out) {
  HWY_DYNAMIC_DISPATCH(pose_log_density)(samples, count, density, rows, out);
}

void add_pose_gradient(const EmRow* rows, const EmRow& shares, std::size_t count,
                       const PoseKernel& density, double* sums) {
  HWY_DYNAMIC_DISPATCH(add_pose_gradient)(rows, shares, count, density, sums);
}

double shares_from_log_terms(const EmRow& weights, std::size_t count, std::span<EmRow> terms) {
  return HWY_DYNAMIC_DISPATCH(shares_of_log_terms)(weights, count, terms.data(), terms.size());
}

}  // namespace posemix::internal
#endif
