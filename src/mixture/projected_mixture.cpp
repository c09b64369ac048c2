// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/projected_mixture.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/base/gaussian_cubature.hpp"

namespace posemix {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Cubature points of a standard normal vector in three dimensions.
const GaussianCubature<3>& cubature() {
  static const auto rule = GaussianCubature<3>::icosahedron();
  return rule;
}

/// Cubature points of one distribution: rotations, the mean of t at each of them, and the
/// covariance `residual` of t about that mean.
template <RotationOrPose G>
struct QuadraturePoints {
  std::vector<SO3d> rotations;
  Eigen::Matrix<double, G::Dof - 3, Eigen::Dynamic> translations;
  Eigen::Matrix<double, G::Dof - 3, G::Dof - 3> residual;

  explicit QuadraturePoints(const ProjectedGaussian<G>& density) {
    const DistributionMoments<G> distribution = moments_of(density);
    const Matrix3d covariance = distribution.covariance.template topLeftCorner<3, 3>();
    const Eigen::LLT<Matrix3d> factor(covariance);
    const Eigen::Matrix<double, 3, Eigen::Dynamic> offsets = factor.matrixL() * cubature().points;
    const Vector3d mean = distribution.mean.template head<3>();
    for (Eigen::Index k = 0; k < offsets.cols(); ++k) {
      rotations.push_back(gnomonic::project(density.tangent_point(), mean + offsets.col(k)));
    }
    if constexpr (std::same_as<G, SE3d>) {
      const Matrix3d cross = distribution.covariance.template bottomLeftCorner<3, 3>();
      const Matrix3d gain = factor.solve(cross.transpose()).transpose();
      translations = (gain * offsets).colwise() + Vector3d(distribution.mean.template tail<3>());
      residual =
          distribution.covariance.template bottomRightCorner<3, 3>() - gain * cross.transpose();
    }
  }
};

/// Weights that sum to one, and the densities that they belong to.
template <RotationOrPose G>
struct Weighted {
  std::vector<double> weights;
  std::vector<const ProjectedGaussian<G>*> densities;

  explicit Weighted(std::span<const Component<ProjectedGaussian<G>>> components) {
    const internal::LogScale scale = internal::checked_log_scale(components);
    for (const auto& component : components) {
      const double weight = std::exp(scale(component.log_weight));
      if (weight == 0.0) continue;
      weights.push_back(weight);
      densities.push_back(&component.density);
    }
  }
};

/// The normalised sum of the quaternions, each with the sign that is nearer to the heaviest one.
SO3d chordal_start(std::span<const SO3d> rotations, std::span<const double> weights) {
  const auto heaviest = std::max_element(weights.begin(), weights.end()) - weights.begin();
  const Eigen::Vector4d first = rotations[static_cast<std::size_t>(heaviest)].quaternion().coeffs();
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Eigen::Vector4d q = rotations[i].quaternion().coeffs();
    sum += std::copysign(weights[i], q.dot(first)) * q;
  }
  return SO3d::from_quaternion(Eigen::Quaterniond(sum));
}

}  // namespace

MeanResult<SO3d> gnomonic_mean(std::span<const SO3d> rotations, std::span<const double> weights,
                               const MeanSettings& settings) {
  const double total = checked_weight_sum(rotations.size(), weights);
  MeanResult<SO3d> result{chordal_start(rotations, weights)};
  while (true) {
    Vector3d mean = Vector3d::Zero();
    Matrix3d curvature = Matrix3d::Identity();
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      if (!(weights[i] > 0.0)) continue;
      const Vector3d u = gnomonic::lift(result.mean, rotations[i]);
      mean += weights[i] / total * u;
      curvature += weights[i] / total * u * u.transpose();
    }
    result.residual = mean.norm();
    const double reach = std::sqrt(curvature.trace());
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    result.converged = result.residual <= std::max(settings.tolerance, kRounding * reach);
    const bool stuck = !mean.allFinite() || result.iterations >= settings.max_iterations;
    if (result.converged || stuck) return result;
    result.mean = gnomonic::project(result.mean, curvature.llt().solve(mean));
    ++result.iterations;
  }
}

template <RotationOrPose G>
ProjectedGaussian<G> tangent_moments(std::span<const Component<ProjectedGaussian<G>>> components,
                                     const SO3d& tangent_point) {
  const Weighted<G> of(components);
  std::vector<ProjectedGaussian<G>> moved;
  typename G::Tangent mean = G::Tangent::Zero();
  for (std::size_t i = 0; i < of.weights.size(); ++i) {
    moved.push_back(change_chart(*of.densities[i], tangent_point));
    mean += of.weights[i] * moved.back().tangent_mean();
  }
  typename G::TangentMatrix covariance = G::TangentMatrix::Zero();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const typename G::Tangent d = moved[i].tangent_mean() - mean;
    covariance += of.weights[i] * (moved[i].covariance() + d * d.transpose());
  }
  symmetrize(covariance);
  return ProjectedGaussian<G>::trusted(tangent_point, mean, covariance);
}

template <RotationOrPose G>
Moments<ProjectedGaussian<G>> moments(std::span<const Component<ProjectedGaussian<G>>> components,
                                      const MomentSettings& settings) {
  const Weighted<G> of(components);
  std::vector<QuadraturePoints<G>> distributions;
  std::vector<SO3d> rotations;
  std::vector<double> weights;
  for (std::size_t i = 0; i < of.weights.size(); ++i) {
    distributions.emplace_back(*of.densities[i]);
    for (const double weight : cubature().weights) weights.push_back(of.weights[i] * weight);
    rotations.insert(rotations.end(), distributions[i].rotations.begin(),
                     distributions[i].rotations.end());
  }
  const MeanResult<SO3d> centre =
      gnomonic_mean(rotations, weights, {settings.max_iterations, settings.tolerance});

  Eigen::Matrix<double, G::Dof, Eigen::Dynamic> y(G::Dof,
                                                  static_cast<Eigen::Index>(rotations.size()));
  typename G::TangentMatrix covariance = G::TangentMatrix::Zero();
  for (std::size_t i = 0; i < distributions.size(); ++i) {
    const Eigen::Index points = cubature().weights.size();
    auto part = y.middleCols(static_cast<Eigen::Index>(i) * points, points);
    for (Eigen::Index k = 0; k < points; ++k) {
      part.col(k).template head<3>() =
          gnomonic::lift(centre.mean, distributions[i].rotations[static_cast<std::size_t>(k)]);
    }
    if constexpr (std::same_as<G, SE3d>) {
      part.template bottomRows<3>() = distributions[i].translations;
      covariance.template bottomRightCorner<3, 3>() += of.weights[i] * distributions[i].residual;
    }
  }
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), y.cols());
  typename G::Tangent mean = y * w;
  mean.template head<3>().setZero();
  y.colwise() -= mean;
  covariance += y * w.asDiagonal() * y.transpose();
  symmetrize(covariance);
  return {with_moments<G>(centre.mean, mean, covariance), centre.converged, centre.iterations,
          centre.residual};
}

template ProjectedGaussian<SO3d> tangent_moments(
    std::span<const Component<ProjectedGaussian<SO3d>>>, const SO3d&);
template Moments<ProjectedGaussian<SO3d>> moments(
    std::span<const Component<ProjectedGaussian<SO3d>>>, const MomentSettings&);
template ProjectedGaussian<SE3d> tangent_moments(
    std::span<const Component<ProjectedGaussian<SE3d>>>, const SO3d&);
template Moments<ProjectedGaussian<SE3d>> moments(
    std::span<const Component<ProjectedGaussian<SE3d>>>, const MomentSettings&);

}  // namespace posemix
