// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/projected_gaussian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "far_tangent.hpp"
#include "posemix/density/projected_moments.hpp"
#include "posemix/lie/rotation_of.hpp"

namespace posemix {
namespace {

/// The mean of y of the density PG_0 with its mode at an element.
SO3d::Tangent zero_form(const SO3d&) { return SO3d::Tangent::Zero(); }
SE3d::Tangent zero_form(const SE3d& element) {
  SE3d::Tangent y;
  y << Eigen::Vector3d::Zero(), element.translation();
  return y;
}

/// Of a thousand proposals one is accepted.
constexpr double kLogRareAcceptance = -6.9;

/// A rotation drawn from the Haar measure.
SO3d uniform_rotation(RandomStream& stream) {
  Eigen::Vector4d q;
  do {
    for (double& value : q) value = stream.normal();
  } while (q.squaredNorm() < 1e-12);
  return SO3d::from_quaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
}

/// One draw of y where the mean is so far from the tangent point that no proposal is accepted: u,
/// and then the rest given u.
template <class G>
typename G::Tangent far_draw(const ProjectedGaussian<G>& density, const Eigen::Matrix3d& l_u,
                             RandomStream& stream) {
  const Eigen::Vector3d mean = density.tangent_mean().template head<3>();
  const internal::FarTangent far(mean, density.covariance().template topLeftCorner<3, 3>());
  const Eigen::Vector3d u = far.sample(stream);
  typename G::Tangent white;
  for (double& value : white) value = stream.normal();
  white.template head<3>() = l_u.template triangularView<Eigen::Lower>().solve(u - mean);
  return density.tangent_mean() + typename G::Tangent(density.covariance().llt().matrixL() * white);
}

}  // namespace

template <RotationOrPose G>
ProjectedGaussian<G>::ProjectedGaussian(const SO3d& tangent_point, const Tangent& mean,
                                        const Covariance& covariance, internal::Unchecked /*tag*/)
    : tangent_point_(tangent_point),
      mean_(mean),
      covariance_(covariance),
      log_normalizer_(projected_log_normalizer(
          mean_.template head<3>(), Eigen::Matrix3d(covariance_.template topLeftCorner<3, 3>()))) {}

template <RotationOrPose G>
ProjectedGaussian<G>::ProjectedGaussian(const SO3d& tangent_point, const Tangent& mean,
                                        const Covariance& covariance)
    : ProjectedGaussian(tangent_point, mean, checked_covariance(covariance, G::Dof, "covariance"),
                        internal::Unchecked()) {
  if (!mean.allFinite() || !tangent_point.quaternion().coeffs().allFinite())
    throw InvalidInput("mean holds a value that is not finite");
}

template <RotationOrPose G>
ProjectedGaussian<G>::ProjectedGaussian(const G& mean, const Covariance& covariance)
    : ProjectedGaussian(rotation_of(mean), zero_form(mean), covariance) {}

template <RotationOrPose G>
ProjectedGaussian<G> ProjectedGaussian<G>::trusted(const SO3d& tangent_point, const Tangent& mean,
                                                   const Covariance& covariance) {
  return ProjectedGaussian(tangent_point, mean, covariance, internal::Unchecked());
}

template <RotationOrPose G>
ProjectedGaussian<G> ProjectedGaussian<G>::trusted(const G& mean, const Covariance& covariance) {
  return ProjectedGaussian(rotation_of(mean), zero_form(mean), covariance, internal::Unchecked());
}

template <RotationOrPose G>
G ProjectedGaussian<G>::element(const Tangent& y) const {
  SO3d rotation = gnomonic::project(tangent_point_, y.template head<3>());
  if constexpr (std::same_as<G, SE3d>) {
    return SE3d(rotation, y.template tail<3>());
  } else {
    return rotation;
  }
}

template <RotationOrPose G>
typename G::Tangent ProjectedGaussian<G>::coordinates(const G& element) const {
  Tangent y = zero_form(element);
  y.template head<3>() = gnomonic::lift(tangent_point_, rotation_of(element));
  return y;
}

template <RotationOrPose G>
G ProjectedGaussian<G>::sample_by_projection(RandomStream& stream) const {
  Tangent white;
  for (double& value : white) value = stream.normal();
  return element(mean_ + Tangent(covariance_.llt().matrixL() * white));
}

template <RotationOrPose G>
G ProjectedGaussian<G>::sample(RandomStream& stream) const {
  const Eigen::LLT<Covariance> factor(covariance_);
  const auto l = factor.matrixL();
  const Eigen::Matrix3d l_u =
      factor.matrixLLT().template topLeftCorner<3, 3>().template triangularView<Eigen::Lower>();
  // The acceptance rate is C for proposals from the Gaussian, and C (2 pi)^(3/2) |P_uu|^(1/2) /
  // pi^2 for uniform rotations.
  constexpr double pi = std::numbers::pi;
  const double size = std::pow(2.0 * pi, 1.5) * l_u.diagonal().prod();
  const bool from_gaussian = size <= pi * pi;
  const double log_uniform = std::log(size / (pi * pi));
  if (!(log_normalizer_ + std::max(0.0, log_uniform) > kLogRareAcceptance))
    return element(far_draw(*this, l_u, stream));
  Tangent white;
  while (true) {
    double log_acceptance;
    if (from_gaussian) {
      for (double& value : white) value = stream.normal();
      const Eigen::Vector3d u = mean_.template head<3>() + l_u * white.template head<3>();
      log_acceptance = -2.0 * std::log1p(u.squaredNorm());
    } else {
      const Eigen::Vector3d u = gnomonic::lift(SO3d(), uniform_rotation(stream));
      for (double& value : white) value = stream.normal();
      white.template head<3>() =
          l_u.template triangularView<Eigen::Lower>().solve(u - mean_.template head<3>());
      log_acceptance = -0.5 * white.template head<3>().squaredNorm();
    }
    if (std::log1p(-stream.uniform()) <= log_acceptance) {
      return element(mean_ + Tangent(l * white));
    }
  }
}

template <RotationOrPose G>
ProjectedGaussian<G>::Evaluator::Evaluator(const ProjectedGaussian& density)
    : tangent_point_(density.tangent_point()), mean_(density.tangent_mean()) {
  const Eigen::LLT<Covariance> factor(density.covariance());
  inverse_factor_ = factor.matrixL().solve(Covariance::Identity());
  log_constant_ = -0.5 * (log_det(factor) + G::Dof * kLogTwoPi) - density.log_normalizer() -
                  gnomonic::kLogHaarPerHalfSphere;
}

template <RotationOrPose G>
double ProjectedGaussian<G>::Evaluator::log_density(const G& element) const {
  Tangent y = zero_form(element);
  y.template head<3>() = gnomonic::lift(tangent_point_, rotation_of(element));
  const double squared =
      (inverse_factor_.template triangularView<Eigen::Lower>() * Tangent(y - mean_)).squaredNorm();
  return std::isfinite(squared) ? log_constant_ - 0.5 * squared
                                : -std::numeric_limits<double>::infinity();
}

template <RotationOrPose G>
DistributionMoments<G> moments_of(const ProjectedGaussian<G>& density) {
  const Eigen::Vector3d mu = density.tangent_mean().template head<3>();
  const Eigen::Matrix3d s_uu = density.covariance().template topLeftCorner<3, 3>();
  const ProjectedMoments of_u = projected_moments(mu, s_uu);
  const Eigen::Matrix3d covariance_u = of_u.second_moment - of_u.mean * of_u.mean.transpose();
  DistributionMoments<G> distribution{density.tangent_mean(), density.covariance(),
                                      density.tangent_point().matrix() * of_u.rotation};
  distribution.mean.template head<3>() = of_u.mean;
  distribution.covariance.template topLeftCorner<3, 3>() = covariance_u;
  if constexpr (std::same_as<G, SE3d>) {  // t given u is Gaussian: E[t | u] = mu_t + B (u - mu_u)
    const Eigen::Matrix3d b =
        s_uu.llt().solve(density.covariance().template topRightCorner<3, 3>()).transpose();
    distribution.mean.template tail<3>() += b * (of_u.mean - mu);
    const Eigen::Matrix3d cross = b * covariance_u;
    distribution.covariance.template bottomLeftCorner<3, 3>() = cross;
    distribution.covariance.template topRightCorner<3, 3>() = cross.transpose();
    distribution.covariance.template bottomRightCorner<3, 3>() +=
        b * (covariance_u - s_uu) * b.transpose();
  }
  symmetrize(distribution.covariance);
  return distribution;
}

template <RotationOrPose G>
ProjectedGaussian<G> with_moments(const SO3d& tangent_point, const typename G::Tangent& mean,
                                  const typename G::TangentMatrix& covariance) {
  typename G::Tangent y = mean;
  y.template head<3>().setZero();
  typename G::TangentMatrix p = covariance;
  const Eigen::Matrix3d moment = covariance.template topLeftCorner<3, 3>();
  const Eigen::Matrix3d s_uu = projected_covariance_of_moment(moment).covariance;
  p.template topLeftCorner<3, 3>() = s_uu;
  // The regression of t on u and its residual covariance stay the same.
  if constexpr (std::same_as<G, SE3d>) {
    const Eigen::Matrix3d b =
        moment.llt().solve(covariance.template topRightCorner<3, 3>()).transpose();
    p.template bottomLeftCorner<3, 3>() = b * s_uu;
    p.template topRightCorner<3, 3>() = s_uu * b.transpose();
    p.template bottomRightCorner<3, 3>() += b * (s_uu - moment) * b.transpose();
  }
  symmetrize(p);
  return ProjectedGaussian<G>::trusted(tangent_point, y, p);
}

template <RotationOrPose G>
ProjectedGaussian<G> change_chart(const ProjectedGaussian<G>& density, const SO3d& tangent_point) {
  using Tangent = typename G::Tangent;
  using Covariance = typename G::TangentMatrix;
  const gnomonic::ChartChange f(density.tangent_point(), tangent_point);
  const Eigen::Vector3d u = density.tangent_mean().template head<3>();
  Tangent mean = density.tangent_mean();
  mean.template head<3>() = f(u);
  if (!mean.allFinite()) {
    throw InvalidInput("change_chart: the mean lies by pi from the new tangent point");
  }
  Covariance j = Covariance::Identity();
  j.template topLeftCorner<3, 3>() = f.jacobian(u);
  Covariance covariance = j * density.covariance() * j.transpose();
  symmetrize(covariance);
  return ProjectedGaussian<G>::trusted(tangent_point, mean, covariance);
}

template class ProjectedGaussian<SO3d>;
template class ProjectedGaussian<SE3d>;
template DistributionMoments<SO3d> moments_of(const ProjectedGaussian<SO3d>&);
template DistributionMoments<SE3d> moments_of(const ProjectedGaussian<SE3d>&);
template ProjectedGaussian<SO3d> with_moments(const SO3d&, const Eigen::Vector3d&,
                                              const Eigen::Matrix3d&);
template ProjectedGaussian<SE3d> with_moments(const SO3d&, const Vector6d&, const Matrix6d&);
template ProjectedGaussian<SO3d> change_chart(const ProjectedGaussian<SO3d>&, const SO3d&);
template ProjectedGaussian<SE3d> change_chart(const ProjectedGaussian<SE3d>&, const SO3d&);

}  // namespace posemix
