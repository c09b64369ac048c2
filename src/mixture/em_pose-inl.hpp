// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors

// Concentrated Gaussians on SE(3) under EM. Included once for every set of vector instructions.
#if defined(POSEMIX_EM_POSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef POSEMIX_EM_POSE_INL
#undef POSEMIX_EM_POSE_INL
#else
#define POSEMIX_EM_POSE_INL
#endif

#include "em_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Twice dD/du: ((t/2)^2 / sin^2(t/2) + (t/2) cot(t/2) - 2) / u^2.
HWY_INLINE V twice_slope_of(V ratio, V second_order, V u) {
  const V rational = hn::NegMulAdd(second_order, u, hn::MulSub(ratio, ratio, set(1.0)));
  const V closed = hn::Div(rational, hn::Mul(u, u));
  const V small = series(
      u, {2.0 / 720, 4.0 / 30240, 6.0 / 1209600, 8.0 / 47900160, 10.0 * 691.0 / 1307674368000.0});
  return hn::IfThenElse(hn::Lt(u, set(kSeriesBelow)), small, closed);
}

/// The sign bit of a quaternion's w. Of the two quaternions of a half turn, w = 0, that one is
/// taken whose first coordinate other than zero is positive, as SO3::log() does.
HWY_INLINE V sign_of(const Quaternion& r) {
  const V zero = hn::Zero(D());
  const auto half_turn = hn::Eq(r.w, zero);
  V decides = r.w;
  if (!hn::AllFalse(D(), half_turn)) {
    const V y_or_z = hn::IfThenElse(hn::Ne(r.v.y, zero), r.v.y, r.v.z);
    const V first = hn::IfThenElse(hn::Ne(r.v.x, zero), r.v.x, y_or_z);
    decides = hn::IfThenElse(half_turn, first, r.w);
  }
  return hn::And(decides, hn::SignBit(D()));
}

/// With phi = Log(X X0^-1), whose log volume is half of that of a pose.
void rotation_log_density(const EmRow* samples, std::size_t count, const RotationKernel& density,
                          EmRow& out) {
  const Quaternion inverse{
      {set(-density.rotation[0]), set(-density.rotation[1]), set(-density.rotation[2])},
      set(density.rotation[3])};
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const Quaternion r = product(load_rotation(samples, i), inverse);
    const Powers powers(hn::Abs(r.w));
    const V ratio = powers.polynomial(kHalfAngleOverSine);
    const V pose_log_volume = powers.polynomial(kLogVolume);
    const V twice = hn::Add(ratio, ratio);
    const V3 phi = scaled(hn::Xor(twice, sign_of(r)), r.v);
    const V xi[3] = {phi.x, phi.y, phi.z};
    const V minus_twice_log = hn::Add(squared_norm<3>(density.factor, xi), pose_log_volume);
    store(hn::NegMulAdd(set(0.5), minus_twice_log, set(density.log_constant)), out, i);
  }
}

/// With J_l^-1(phi) = I - phi^ / 2 + D phi^ phi^, D = `second_order`, and J_l^-1(phi) R(phi) =
/// J_l^-1(-phi),
///   rho = J_l^-1(phi) (t - R t0) = t - t0 + phi x (D phi x (t - t0) - (t + t0) / 2).
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
    const V3 phi = scaled(hn::Xor(twice, sign_of(r)), r.v);
    const V second_order = second_order_of(ratio, cosine, hn::Mul(twice, twice));
    const V3 t = load3(samples + 4, i);
    const V3 d = {hn::Sub(t.x, centre.x), hn::Sub(t.y, centre.y), hn::Sub(t.z, centre.z)};
    const V3 turned = cross(phi, d);
    const V3 g = scaled_difference(second_order, turned, scaled_sum(set(0.5), t, half_centre));
    const V3 rho = cross_sum(phi, g, d);
    const V xi[6] = {phi.x, phi.y, phi.z, rho.x, rho.y, rho.z};
    const V squared = squared_norm<6>(density.factor, xi);
    store3(phi, rows, i);
    store3(rho, rows + 3, i);
    store(ratio, rows[kRatio], i);
    store(second_order, rows[kSecondOrder], i);
    store(squared, rows[kSquared], i);
    store(hn::NegMulAdd(set(0.5), squared, hn::Sub(set(density.log_constant), log_volume)), out, i);
  }
}

/// The sums of the part of J_r^-T y that is not linear in second moments. With phi^ phi^ y = phi
/// (phi.y) - phi.phi y, y = [y1; y2], a = share D and b = 2 share phi.rho dD/du, they are
///   phi (a (xi.y - 4) + b phi.y2) + rho (a phi.y2) - a phi.phi y1 - (2 a phi.rho + b phi.phi) y2
/// for the first three coordinates and
///   phi (a phi.y2) - a phi.phi y2
/// for the last three. -4 a phi comes from the volume; y = P^-1 xi is linear, so that P^-1 can be
/// applied to the sums.
void add_pose_gradient(const EmRow* rows, const EmRow& shares, std::size_t count,
                       const PoseKernel& density, double* sums) {
  V total[kPoseGradientSums];
  for (std::size_t j = 0; j < kPoseGradientSums; ++j) total[j] = load_sum(sums, j);
  const auto& p = density.precision;
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V share = load(shares, i);
    if (none(share)) continue;
    const V3 phi = load3(rows + kXi, i);
    const V3 rho = load3(rows + kXi + 3, i);
    const V xi[6] = {phi.x, phi.y, phi.z, rho.x, rho.y, rho.z};
    const V3 y2 = {row_times(p[3], xi, 6), row_times(p[4], xi, 6), row_times(p[5], xi, 6)};
    const V a = hn::Mul(share, load(rows[kSecondOrder], i));
    const V phi_rho = dot(phi, rho);
    const V phi_phi = dot(phi, phi);
    const V slope =
        hn::Mul(share, twice_slope_of(load(rows[kRatio], i), load(rows[kSecondOrder], i), phi_phi));
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
  for (std::size_t j = 0; j < kPoseGradientSums; ++j) store_sum(total[j], sums, j);
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#endif
