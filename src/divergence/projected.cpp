// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/divergence/projected.hpp"

#include <cmath>

#include "posemix/lie/rotation_of.hpp"

namespace posemix {
namespace {

/// Two densities in the chart at the rotation that is `share` of the way from the mode of a to that
/// of b.
template <RotationOrPose G>
struct CommonTangent {
  ProjectedGaussian<G> p;
  ProjectedGaussian<G> q;

  CommonTangent(const ProjectedGaussian<G>& a, const ProjectedGaussian<G>& b, double share)
      : p(a), q(b) {
    const Eigen::Vector4d apart =
        a.tangent_point().quaternion().coeffs() - b.tangent_point().quaternion().coeffs();
    if (apart.isZero(0.0)) return;
    const SO3d anchor = interpolate(rotation_of(a.mean()), rotation_of(b.mean()), share);
    p = change_chart(a, anchor);
    q = change_chart(b, anchor);
  }

  typename G::Tangent difference() const { return q.tangent_mean() - p.tangent_mean(); }
};

/// Twice the part of D(p || q) that depends on the moments of p, for Gaussians in one tangent
/// space.
template <class Tangent, class Matrix>
double quadratic_form(const Tangent& mean, const Matrix& covariance, const Tangent& q_mean,
                      const Eigen::LLT<Matrix>& q_factor) {
  return q_factor.solve(covariance).trace() +
         q_factor.matrixL().solve(Tangent(mean - q_mean)).squaredNorm();
}

template <RotationOrPose G>
double gaussian_kl_in(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  using Matrix = typename G::TangentMatrix;
  const Eigen::LLT<Matrix> p_factor(p.covariance());
  const Eigen::LLT<Matrix> q_factor(q.covariance());
  const double form = quadratic_form(p.tangent_mean(), p.covariance(), q.tangent_mean(), q_factor);
  return 0.5 * (form - G::Dof + log_det(q_factor) - log_det(p_factor));
}

template <RotationOrPose G>
double exact_kl_in(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  using Matrix = typename G::TangentMatrix;
  const DistributionMoments<G> distribution = moments_of(p);
  const Eigen::LLT<Matrix> p_factor(p.covariance());
  const Eigen::LLT<Matrix> q_factor(q.covariance());
  const double gap =
      quadratic_form(distribution.mean, distribution.covariance, q.tangent_mean(), q_factor) -
      quadratic_form(distribution.mean, distribution.covariance, p.tangent_mean(), p_factor);
  return 0.5 * (gap + log_det(q_factor) - log_det(p_factor)) + q.log_normalizer() -
         p.log_normalizer();
}

}  // namespace

template <RotationOrPose G>
double gaussian_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  const CommonTangent<G> at(p, q, 0.5);
  return gaussian_kl_in(at.p, at.q);
}

template <RotationOrPose G>
double gaussian_symmetric_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  const CommonTangent<G> at(p, q, 0.5);
  return gaussian_kl_in(at.p, at.q) + gaussian_kl_in(at.q, at.p);
}

template <RotationOrPose G>
double exact_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  const CommonTangent<G> at(p, q, 0.5);
  return exact_kl_in(at.p, at.q);
}

template <RotationOrPose G>
double exact_symmetric_kl(const ProjectedGaussian<G>& p, const ProjectedGaussian<G>& q) {
  const CommonTangent<G> at(p, q, 0.5);
  return exact_kl_in(at.p, at.q) + exact_kl_in(at.q, at.p);
}

template <RotationOrPose G>
double runnalls_bound(const Component<ProjectedGaussian<G>>& a,
                      const Component<ProjectedGaussian<G>>& b) {
  using Matrix = typename G::TangentMatrix;
  const double w_a = std::exp(a.log_weight);
  const double w_b = std::exp(b.log_weight);
  if (w_a + w_b == 0.0) return 0.0;
  const double share = w_b / (w_a + w_b);
  const CommonTangent<G> at(a.density, b.density, share);
  const typename G::Tangent d = at.difference();
  const Matrix merged = (1.0 - share) * at.p.covariance() + share * at.q.covariance() +
                        (share * (1.0 - share)) * d * d.transpose();
  const auto log_det_of = [](const Matrix& covariance) {
    return log_det(Eigen::LLT<Matrix>(covariance));
  };
  return 0.5 * ((w_a + w_b) * log_det_of(merged) - w_a * log_det_of(at.p.covariance()) -
                w_b * log_det_of(at.q.covariance()));
}

template <RotationOrPose G>
double mahalanobis_distance(const ProjectedGaussian<G>& a, const ProjectedGaussian<G>& b) {
  const CommonTangent<G> at(a, b, 0.5);
  const Eigen::LLT<typename G::TangentMatrix> sum(at.p.covariance() + at.q.covariance());
  return sum.matrixL().solve(at.difference()).norm();
}

template <RotationOrPose G>
using Divergence = double(const ProjectedGaussian<G>&, const ProjectedGaussian<G>&);

template Divergence<SO3d> gaussian_kl<SO3d>;
template Divergence<SO3d> gaussian_symmetric_kl<SO3d>;
template Divergence<SO3d> exact_kl<SO3d>;
template Divergence<SO3d> exact_symmetric_kl<SO3d>;
template Divergence<SO3d> mahalanobis_distance<SO3d>;
template double runnalls_bound(const Component<ProjectedGaussian<SO3d>>&,
                               const Component<ProjectedGaussian<SO3d>>&);
template Divergence<SE3d> gaussian_kl<SE3d>;
template Divergence<SE3d> gaussian_symmetric_kl<SE3d>;
template Divergence<SE3d> exact_kl<SE3d>;
template Divergence<SE3d> exact_symmetric_kl<SE3d>;
template Divergence<SE3d> mahalanobis_distance<SE3d>;
template double runnalls_bound(const Component<ProjectedGaussian<SE3d>>&,
                               const Component<ProjectedGaussian<SE3d>>&);

}  // namespace posemix
