// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <array>

#include <Eigen/Eigenvalues>

#include "posemix/density/projected_moments.hpp"
#include "posemix/mixture/em.hpp"

namespace posemix::internal {
namespace {

/// No variance of u is larger: the law is uniform but for little.
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

/// ln C(l) + sum (ln l + T lambda) / 2 in lambda = 1 / l, convex, and its derivatives, for the
/// diagonal covariance l and the moments T.
struct Cost {
  double value;
  Eigen::Vector3d gradient;

  Cost(const Eigen::Vector3d& lambda, const Eigen::Vector3d& target) {
    const Eigen::Vector3d l = lambda.cwiseInverse();
    const ProjectedMoments moments =
        projected_moments(Eigen::Vector3d::Zero(), Eigen::Matrix3d(l.asDiagonal()));
    value = moments.log_normalizer + 0.5 * (l.array().log().sum() + target.dot(lambda));
    gradient = 0.5 * (target - moments.second_moment.diagonal());
  }
};

/// The second derivative by differences; rows and columns that are not free are those of I.
Eigen::Matrix3d hessian(const Eigen::Vector3d& lambda, const Eigen::Vector3d& target,
                        const Cost& at, const std::array<bool, 3>& free) {
  Eigen::Matrix3d h = Eigen::Matrix3d::Identity();
  for (std::size_t column = 0; column < 3; ++column) {
    if (!free[column]) continue;
    const auto j = static_cast<Eigen::Index>(column);
    Eigen::Vector3d moved = lambda;
    moved[j] *= 1.0 + 1e-6;
    const Eigen::Vector3d slope =
        (Cost(moved, target).gradient - at.gradient) / (moved[j] - lambda[j]);
    for (std::size_t row = 0; row < 3; ++row) {
      if (free[row]) h(static_cast<Eigen::Index>(row), j) = slope[static_cast<Eigen::Index>(row)];
    }
  }
  return h;
}

/// Newton's method in lambda within bounds, with halved steps, from a first guess.
Eigen::Vector3d fit_within(const Eigen::Vector3d& target, const Bounds& bounds,
                           const Eigen::Vector3d& guess) {
  const Eigen::Vector3d least = bounds.upper.cwiseInverse();
  const Eigen::Vector3d most = bounds.lower.cwiseInverse();
  Eigen::Vector3d lambda = guess.cwiseInverse().cwiseMax(least).cwiseMin(most);
  Cost at(lambda, target);
  for (int iteration = 0; iteration < 60; ++iteration) {
    std::array<bool, 3> free{};
    Eigen::Vector3d slope = at.gradient;
    bool done = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      free[i] = slope[j] > 0.0 ? lambda[j] > least[j] : lambda[j] < most[j];
      if (!free[i]) slope[j] = 0.0;
      done = done && std::abs(slope[j]) <= 1e-13 * target[j];
    }
    if (done) break;
    const Eigen::Vector3d newton = hessian(lambda, target, at, free).partialPivLu().solve(-slope);
    bool moved = false;
    for (double step = 1.0; step > 1e-9 && !moved; step *= 0.5) {
      const Eigen::Vector3d next =
          (lambda + step * newton).cwiseMax(0.2 * lambda).cwiseMax(least).cwiseMin(most);
      const Cost there(next, target);
      if (!(there.value <= at.value) || next == lambda) continue;
      lambda = next;
      at = there;
      moved = true;
    }
    if (!moved) break;
  }
  return lambda.cwiseInverse();
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
  target = target.cwiseMax(1e-300);
  const ProjectedCovariance fit =
      projected_covariance_of_moment(Eigen::Matrix3d(target.asDiagonal()), kWidest);
  Eigen::Vector3d l = fit.covariance.diagonal();
  const bool inside =
      (l.array() >= bounds.lower.array()).all() && (l.array() <= bounds.upper.array()).all();
  if (!inside || !fit.converged) l = fit_within(target, bounds, l);
  Eigen::Matrix3d covariance = axes * l.asDiagonal() * axes.transpose();
  symmetrize(covariance);
  return covariance;
}

}  // namespace posemix::internal
