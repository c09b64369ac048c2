// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>

#include "posemix/lie/mean.hpp"
#include "posemix/mixture/tangent_moments.hpp"

/// Divergences between two densities in closed form: both are moved to the tangent space at the
/// midpoint of their means (first order, as in `recenter`) and compared there as Gaussians in a
/// vector space.
namespace posemix {

namespace internal {

/// Two densities in one tangent space.
template <LieGroup G>
struct CommonTangent {
  TangentGaussian<G> p;
  TangentGaussian<G> q;

  CommonTangent(const ConcentratedGaussian<G>& a, const ConcentratedGaussian<G>& b, const G& anchor)
      : p(recenter(a, anchor)), q(recenter(b, anchor)) {}
};

}  // namespace internal

/// Kullback-Leibler divergence D(p || q) [nats], in closed form in the tangent space at the
/// midpoint.
template <LieGroup G>
double gaussian_kl(const ConcentratedGaussian<G>& p, const ConcentratedGaussian<G>& q) {
  const internal::CommonTangent<G> at(p, q, interpolate(p.mean(), q.mean(), 0.5));
  const Eigen::LLT<typename G::TangentMatrix> p_factor(at.p.covariance);
  const Eigen::LLT<typename G::TangentMatrix> q_factor(at.q.covariance);
  const typename G::Tangent d = at.q.mean - at.p.mean;
  const double trace = q_factor.solve(at.p.covariance).trace();
  const double squared = q_factor.matrixL().solve(d).squaredNorm();
  return 0.5 *
         (trace + squared - static_cast<double>(p.dof()) + log_det(q_factor) - log_det(p_factor));
}

/// D(p || q) + D(q || p) [nats], in closed form in the tangent space at the midpoint.
template <LieGroup G>
double gaussian_symmetric_kl(const ConcentratedGaussian<G>& p, const ConcentratedGaussian<G>& q) {
  return gaussian_kl(p, q) + gaussian_kl(q, p);
}

/// Runnalls' upper bound on the divergence between a mixture and itself after merging two
/// components, with w_i = exp(log_weight_i) and covariances in the tangent space at the midway
/// point of the two (Runnalls 2007):
///   [(w_a + w_b) log|P_ab| - w_a log|P_a| - w_b log|P_b|] / 2.
template <LieGroup G>
double runnalls_bound(const Component<ConcentratedGaussian<G>>& a,
                      const Component<ConcentratedGaussian<G>>& b) {
  const double w_a = std::exp(a.log_weight);
  const double w_b = std::exp(b.log_weight);
  if (w_a + w_b == 0.0) return 0.0;
  const G anchor = interpolate(a.density.mean(), b.density.mean(), w_b / (w_a + w_b));
  const internal::CommonTangent<G> at(a.density, b.density, anchor);
  const typename G::Tangent d = at.q.mean - at.p.mean;
  const double u = w_a / (w_a + w_b);
  const typename G::TangentMatrix merged =
      u * at.p.covariance + (1.0 - u) * at.q.covariance + (u * (1.0 - u)) * d * d.transpose();
  const auto log_det_of = [](const typename G::TangentMatrix& covariance) {
    return log_det(Eigen::LLT<typename G::TangentMatrix>(covariance));
  };
  return 0.5 * ((w_a + w_b) * log_det_of(merged) - w_a * log_det_of(at.p.covariance) -
                w_b * log_det_of(at.q.covariance));
}

// NOLINTBEGIN(bugprone-macro-parentheses): types and keywords take none
#define POSEMIX_GAUSSIAN_DIVERGENCE(prefix, G)                                     \
  prefix template double gaussian_kl(const ConcentratedGaussian<G>&,               \
                                     const ConcentratedGaussian<G>&);              \
  prefix template double gaussian_symmetric_kl(const ConcentratedGaussian<G>&,     \
                                               const ConcentratedGaussian<G>&);    \
  prefix template double runnalls_bound(const Component<ConcentratedGaussian<G>>&, \
                                        const Component<ConcentratedGaussian<G>>&)
// NOLINTEND(bugprone-macro-parentheses)
POSEMIX_GAUSSIAN_DIVERGENCE(extern, SO3d);
POSEMIX_GAUSSIAN_DIVERGENCE(extern, SE3d);
POSEMIX_GAUSSIAN_DIVERGENCE(extern, PoseStackd);
POSEMIX_GAUSSIAN_DIVERGENCE(extern, Rnd<3>);

}  // namespace posemix
