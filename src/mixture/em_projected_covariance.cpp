// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <Eigen/Eigenvalues>

#include "posemix/density/projected_moments.hpp"
#include "posemix/mixture/em.hpp"

namespace posemix::internal {
namespace {

/// The largest variance of u; the distribution is then nearly uniform.
constexpr double kWidest = 1e4;

/// Bounds of the variances of u along three axes.
struct Bounds {
  Eigen::Vector3d lower;
  Eigen::Vector3d upper;
};

Bounds bounds_of(const EmSettings& settings) {
  const Eigen::Vector3d half =
      0.5 * (settings.unit.size() == 0 ? Eigen::Vector3d(Eigen::Vector3d::Ones())
                                       : Eigen::Vector3d(settings.unit.head<3>()));
  if (!settings.diagonal && (half.array() != half[0]).any()) {
    throw InvalidInput(
        fmt::format("EM: the units of rotation are {}, {} and {}, expected equal ones for full "
                    "covariances of projected Gaussians",
                    2.0 * half[0], 2.0 * half[1], 2.0 * half[2]));
  }
  const Eigen::Vector3d lower = (settings.min_sd * half).cwiseAbs2();
  const Eigen::Vector3d upper = (settings.max_sd * half).cwiseAbs2().cwiseMin(kWidest);
  return {lower, upper.cwiseMax(lower)};
}

}  // namespace

Eigen::Matrix3d bounded_projected_covariance(const Eigen::Matrix3d& second_moment,
                                             const EmSettings& settings) {
  const Bounds bounds = bounds_of(settings);
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d target = second_moment.diagonal();
  if (!settings.diagonal) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(second_moment);
    axes = eigen.eigenvectors();
    target = eigen.eigenvalues();
  }
  const Eigen::Vector3d l =
      projected_variances_of_moments(target, bounds.lower, bounds.upper).variances;
  Eigen::Matrix3d covariance = axes * l.asDiagonal() * axes.transpose();
  symmetrize(covariance);
  return covariance;
}

Eigen::Matrix3d clipped_projected_covariance(const Eigen::Matrix3d& covariance,
                                             const EmSettings& settings) {
  const Bounds bounds = bounds_of(settings);
  if (settings.diagonal) {
    const Eigen::Vector3d variances = covariance.diagonal();
    return variances.cwiseMax(bounds.lower).cwiseMin(bounds.upper).asDiagonal();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const Eigen::Vector3d& values = eigen.eigenvalues();
  const Eigen::Vector3d within = values.cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  if (within == values) return covariance;
  Eigen::Matrix3d clipped =
      eigen.eigenvectors() * within.asDiagonal() * eigen.eigenvectors().transpose();
  symmetrize(clipped);
  return clipped;
}

}  // namespace posemix::internal
