// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "reduction/pair_kernels.hpp"

#include "base/vector_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_kernels.cpp"
#include "hwy/foreach_target.h"
//
#include "base/vector_dispatch.hpp"
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"
#include "lie/pose_vector-inl.hpp"
#include "lie/twist_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace posemix::internal {
namespace HWY_NAMESPACE {

/// Gaussians, one per lane.
struct Gaussians {
  Poses mean;
  Symmetric covariance;
  V log_det;
  V weight;
};

template <class Field>
HWY_INLINE Gaussians gaussians(const Field& field) {
  Gaussians result;
  result.mean = {{{field(0), field(1), field(2)}, field(3)}, {field(4), field(5), field(6)}};
  POSEMIX_UNROLL
  for (std::size_t k = 0; k < 21; ++k) result.covariance.m[k] = field(kFieldCovariance + k);
  result.log_det = field(kFieldLogDet);
  result.weight = field(kFieldWeight);
  return result;
}

HWY_INLINE Tangents scaled_tangents(V s, const Tangents& xi) {
  return {scaled(s, xi.phi), scaled(s, xi.rho)};
}

/// Log(X_b X_a^-1), by the body's axes, which does not lose digits far from the origin.
HWY_INLINE Tangents difference(const Gaussians& a, const Gaussians& b) {
  return times(adjoint(a.mean), log(product(inverse(a.mean), b.mean)));
}

/// log |det J_l|.
HWY_INLINE V log_det_jacobian(const Tangents& xi) {
  const auto half = coefficients<HalfAngle>(dot(xi.phi, xi.phi));
  return hn::Mul(set(4.0), hn::Log(D(), hn::Abs(half.values[HalfAngle::kSinc])));
}

/// log |J_l^-1 P J_l^-T|.
HWY_INLINE V moved_log_det(const Gaussians& a, const Tangents& xi) {
  return hn::NegMulAdd(set(2.0), log_det_jacobian(xi), a.log_det);
}

/// D(p || q) + D(q || p) in the tangent space at the midpoint.
/// Infinite where rounding leaves a covariance no factor: such a pair is merged last.
HWY_INLINE V symmetric_kl(const Gaussians& a, const Gaussians& b) {
  const Tangents d = difference(a, b);
  const Symmetric p =
      congruence(left_jacobian_inverse(scaled_tangents(set(-0.5), d)), a.covariance);
  const Symmetric q = congruence(left_jacobian_inverse(scaled_tangents(set(0.5), d)), b.covariance);
  const Lower p_factor = cholesky(p);
  const Lower q_factor = cholesky(q);
  const V sum = hn::Add(
      hn::Add(squared_norm(solved(q_factor, p_factor)), squared_norm(solved(p_factor, q_factor))),
      hn::Add(squared_norm(solved(p_factor, d)), squared_norm(solved(q_factor, d))));
  const V divergence = hn::MulSub(set(0.5), sum, set(6.0));
  return hn::IfThenElse(hn::IsNaN(divergence), hn::Inf(D()), divergence);
}

/// Runnalls' bound in the tangent space at the midway point. A component without weight costs
/// nothing, whatever rounding leaves of the logarithms.
HWY_INLINE V runnalls(const Gaussians& a, const Gaussians& b) {
  const V total = hn::Add(a.weight, b.weight);
  const auto none = hn::Eq(hn::Mul(a.weight, b.weight), hn::Zero(D()));
  const V divisor = hn::IfThenElse(none, set(1.0), total);
  const V share_a = hn::Div(a.weight, divisor);
  const V share_b = hn::Div(b.weight, divisor);
  const Tangents d = difference(a, b);
  const Tangents to_a = scaled_tangents(hn::Neg(share_b), d);
  const Tangents to_b = scaled_tangents(share_a, d);
  Symmetric merged = outer_product(hn::Mul(share_a, share_b), d);
  add_scaled(share_a, congruence(left_jacobian_inverse(to_a), a.covariance), merged);
  add_scaled(share_b, congruence(left_jacobian_inverse(to_b), b.covariance), merged);
  V cost = hn::Mul(total, log_det(cholesky(merged)));
  cost = hn::NegMulAdd(a.weight, moved_log_det(a, to_a), cost);
  cost = hn::NegMulAdd(b.weight, moved_log_det(b, to_b), cost);
  return hn::IfThenZeroElse(none, hn::Mul(set(0.5), cost));
}

HWY_INLINE V weighted_symmetric_kl(const Gaussians& a, const Gaussians& b) {
  const V both = hn::Mul(a.weight, b.weight);
  const auto none = hn::Eq(both, hn::Zero(D()));
  const V share = hn::Div(a.weight, hn::IfThenElse(none, set(1.0), hn::Add(a.weight, b.weight)));
  return hn::IfThenZeroElse(none, hn::Mul(hn::Mul(share, b.weight), symmetric_kl(a, b)));
}

HWY_INLINE V mahalanobis(const Gaussians& a, const Gaussians& b) {
  Symmetric sum = a.covariance;
  add_scaled(set(1.0), b.covariance, sum);
  const Tangents d = log(product(b.mean, inverse(a.mean)));
  return hn::Sqrt(squared_norm(solved(cholesky(sum), d)));
}

template <class Cost>
HWY_INLINE void for_all(const double* one, const double* columns, std::size_t stride,
                        std::size_t count, double* costs, const Cost& cost) {
  const Gaussians first = gaussians([&](std::size_t k) HWY_ATTR { return set(one[k]); });
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Gaussians others =
        gaussians([&](std::size_t k) HWY_ATTR { return hn::LoadU(D(), columns + k * stride + i); });
    hn::StoreU(cost(others, first), D(), costs + i);
  }
}

void distances(DistanceMetric metric, const double* one, const double* columns, std::size_t stride,
               std::size_t count, double* costs) {
  if (metric == DistanceMetric::mahalanobis) {
    for_all(one, columns, stride, count, costs,
            [](const Gaussians& a, const Gaussians& b)
                HWY_ATTR { return hn::Neg(mahalanobis(a, b)); });
    return;
  }
  const V rotation = set(metric == DistanceMetric::translation ? 0.0 : 1.0);
  const V translation = set(metric == DistanceMetric::rotation ? 0.0 : 1.0);
  for_all(one, columns, stride, count, costs, [&](const Gaussians& a, const Gaussians& b) HWY_ATTR {
    const Tangents d = log(product(b.mean, inverse(a.mean)));
    const V squared =
        hn::MulAdd(rotation, dot(d.phi, d.phi), hn::Mul(translation, dot(d.rho, d.rho)));
    return hn::Neg(hn::Sqrt(squared));
  });
}

void costs_of(PairRule rule, DistanceMetric metric, const double* one, const double* columns,
              std::size_t stride, std::size_t count, double* costs) {
  switch (rule) {
    case PairRule::symmetric_kl:
      for_all(one, columns, stride, count, costs,
              [](const Gaussians& a, const Gaussians& b) HWY_ATTR { return symmetric_kl(a, b); });
      break;
    case PairRule::weighted_symmetric_kl:
      for_all(one, columns, stride, count, costs,
              [](const Gaussians& a, const Gaussians& b)
                  HWY_ATTR { return weighted_symmetric_kl(a, b); });
      break;
    case PairRule::runnalls:
      for_all(one, columns, stride, count, costs,
              [](const Gaussians& a, const Gaussians& b) HWY_ATTR { return runnalls(a, b); });
      break;
    case PairRule::most_distant:
      distances(metric, one, columns, stride, count, costs);
      break;
    case PairRule::largest_with_smallest:
      break;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace posemix::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posemix::internal {

HWY_EXPORT(costs_of);

void pair_costs(PairRule rule, DistanceMetric metric, const double* one, const double* columns,
                std::size_t stride, std::size_t count, double* costs) {
  POSEMIX_DISPATCH(costs_of)(rule, metric, one, columns, stride, count, costs);
}

}  // namespace posemix::internal
#endif
