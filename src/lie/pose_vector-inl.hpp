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

#include <cstddef>

#include "hwy/highway.h"
#include "lie/angle_coefficients-inl.hpp"
#include "lie/half_angle-inl.hpp"

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
  const V3 v = negated(a.rotation.v);
  const V w = a.rotation.w;
  return {{v, w}, negated(turned({v, w}, a.translation))};
}

/// Tangent vectors.
struct Tangents {
  V3 phi;
  V3 rho;
};

/// Exp(phi) from cos and sinc of half the angle and u = phi.phi, with one Newton step towards
/// |q|^2 = cos^2 + sinc^2 u/4 = 1.
HWY_INLINE Quaternion exp(const HalfAngle& half, const V3& phi, V u) {
  const V cosine = half.values[HalfAngle::kCosine];
  const V sine = hn::Mul(set(0.5), half.values[HalfAngle::kSinc]);
  const V squared = hn::MulAdd(hn::Mul(sine, sine), u, hn::Mul(cosine, cosine));
  const V scale = hn::NegMulAdd(set(0.5), squared, set(1.5));
  return {scaled(hn::Mul(scale, sine), phi), hn::Mul(scale, cosine)};
}
HWY_INLINE Quaternion exp(const V3& phi) {
  const V u = dot(phi, phi);
  return exp(coefficients<HalfAngle>(u), phi, u);
}
HWY_INLINE Poses exp(const Tangents& xi) {
  const auto& [phi, rho] = xi;
  const V u = dot(phi, phi);
  const HalfAngle half = coefficients<HalfAngle>(u);
  const V sinc = half.values[HalfAngle::kSinc];
  const V a = hn::Mul(sinc, half.values[HalfAngle::kCosine]);
  const V b = hn::Mul(hn::Mul(set(0.5), sinc), sinc);
  const V c = hn::IfThenZeroElse(hn::Eq(u, hn::Zero(D())), hn::Div(hn::Sub(set(1.0), a), u));
  const V along = hn::Mul(c, dot(phi, rho));
  return {exp(half, phi, u),
          scaled_sum(along, phi, scaled_sum(b, cross(phi, rho), scaled(a, rho)))};
}

/// The quaternion's sign with which w >= 0, or of w = 0 the first component of v that is not zero.
HWY_INLINE V positive_sign(const Quaternion& q) {
  const V zero = hn::Zero(D());
  V deciding = hn::IfThenElse(hn::Eq(q.v.y, zero), q.v.z, q.v.y);
  deciding = hn::IfThenElse(hn::Eq(q.v.x, zero), deciding, q.v.x);
  deciding = hn::IfThenElse(hn::Eq(q.w, zero), deciding, q.w);
  return hn::And(deciding, hn::SignBit(D()));
}

/// (t/2) / sin(t/2) for the angle t.
HWY_INLINE V half_angle_over_sine(V cosine) {
  return Powers(cosine).polynomial(kHalfAngleOverSine);
}
HWY_INLINE V3 log(const Quaternion& q) {
  const V ratio = half_angle_over_sine(hn::Abs(q.w));
  return scaled(hn::Xor(hn::Add(ratio, ratio), positive_sign(q)), q.v);
}

/// rho = (ratio w) t - ratio v x t + outer v v^T t with the half angle's quaternion (w, v), as in
/// SO3.
HWY_INLINE Tangents log(const Poses& x) {
  const auto& [q, t] = x;
  const V sign = positive_sign(q);
  const V w = hn::Abs(q.w);
  const V squared_sine = hn::NegMulAdd(w, w, set(1.0));
  const V inverse = hn::Div(set(1.0), squared_sine);
  const V ratio = half_angle_over_sine(w);
  const V product = hn::Mul(ratio, w);
  const V outer = hn::Mul(hn::Sub(set(1.0), product), hn::Mul(inverse, dot(q.v, t)));
  const V along = hn::IfThenZeroElse(hn::Eq(squared_sine, hn::Zero(D())), outer);
  const V turning = hn::Xor(ratio, sign);
  return {scaled(hn::Add(turning, turning), q.v),
          scaled_sum(along, q.v, scaled_sum(turning, cross(t, q.v), scaled(product, t)))};
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

/// d I + w^ + q p^T for parallel p and q.
HWY_INLINE Matrices hat_plus_outer(V d, const V3& w, const V3& p, const V3& q) {
  return {{hn::MulAdd(q.x, p.x, d), hn::MulAdd(q.y, p.x, w.z), hn::MulSub(q.z, p.x, w.y),  //
           hn::MulSub(q.x, p.y, w.z), hn::MulAdd(q.y, p.y, d), hn::MulAdd(q.z, p.y, w.x),  //
           hn::MulAdd(q.x, p.z, w.y), hn::MulSub(q.y, p.z, w.x), hn::MulAdd(q.z, p.z, d)}};
}

/// The blocks of matrices [a 0; b a].
struct TwistMatrices {
  Matrices a;
  Matrices b;
};

/// J_l^-1.
HWY_INLINE Matrices left_jacobian_inverse(const V3& phi) {
  const InverseCoefficients c = coefficients<InverseCoefficients>(dot(phi, phi));
  return hat_plus_outer(c.values[c.kHalfCot], scaled(set(-0.5), phi), phi,
                        scaled(c.values[c.kD], phi));
}
HWY_INLINE TwistMatrices left_jacobian_inverse(const Tangents& xi) {
  const auto& [phi, rho] = xi;
  const auto c = coefficients<InverseCoefficientsAndSlopes>(dot(phi, phi));
  const V d = c.values[c.kD];
  const V along = dot(phi, rho);
  const V3 q = scaled_sum(hn::Mul(along, c.values[c.kDSlope]), phi, scaled(d, rho));
  return {hat_plus_outer(c.values[c.kHalfCot], scaled(set(-0.5), phi), phi, scaled(d, phi)),
          hat_plus_symmetric(hn::Mul(hn::Add(along, along), c.values[c.kHalfCotSlope]),
                             scaled(set(-0.5), rho), phi, q)};
}

/// J_l.
HWY_INLINE Matrices left_jacobian(const V3& phi) {
  const JacobianCoefficients c = coefficients<JacobianCoefficients>(dot(phi, phi));
  return hat_plus_outer(c.values[c.kA], scaled(c.values[c.kB], phi), phi,
                        scaled(c.values[c.kC], phi));
}
HWY_INLINE TwistMatrices left_jacobian(const Tangents& xi) {
  const auto& [phi, rho] = xi;
  const auto c = coefficients<JacobianCoefficientsAndSlopes>(dot(phi, phi));
  const V b = c.values[c.kB];
  const V along = dot(phi, rho);
  const V du = hn::Add(along, along);
  const V3 w = scaled_sum(hn::Mul(du, c.values[c.kBSlope]), phi, scaled(b, rho));
  const V3 q = scaled_sum(hn::Mul(along, c.values[c.kCSlope]), phi, scaled(c.values[c.kC], rho));
  return {hat_plus_outer(c.values[c.kA], scaled(b, phi), phi, scaled(c.values[c.kC], phi)),
          hat_plus_symmetric(hn::Mul(du, c.a_slope()), w, phi, q)};
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
