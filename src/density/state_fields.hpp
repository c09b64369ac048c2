// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/state_parts.hpp"
#include "posemix/density/concentrated_gaussian.hpp"

/// Poses and Gaussians in a saved state, to the last bit.
namespace posemix::internal {

template <>
struct StateFields<SO3d> {
  using Stored = Eigen::Vector4d;
  static Stored to_stored(const SO3d& x) { return x.quaternion().coeffs(); }
  static SO3d of_stored(const Stored& stored) {
    const Eigen::Quaterniond q(stored);
    // Else the rotation would be normalised, which is another one.
    require_state(std::abs(q.squaredNorm() - 1.0) <= 16.0 * std::numeric_limits<double>::epsilon(),
                  "a quaternion of length one");
    return SO3d::from_stored_quaternion(q);
  }
};

template <>
struct StateFields<SE3d> {
  using Stored = std::pair<SO3d, Eigen::Vector3d>;
  static Stored to_stored(const SE3d& x) { return {x.rotation(), x.translation()}; }
  static SE3d of_stored(const Stored& stored) {
    require_state(stored.second.allFinite(), "a pose with a finite translation");
    return {stored.first, stored.second};
  }
};

template <>
struct StateFields<PoseStackd> {
  using Stored = std::vector<SE3d>;
  static Stored to_stored(const PoseStackd& x) { return x.poses(); }
  static PoseStackd of_stored(Stored stored) { return PoseStackd(std::move(stored)); }
};

/// Whether a symmetric matrix of finite numbers is a covariance but for what computing loses: with
/// 1e-12 of the largest variance added to all of them, which is lost where a wide prior was, and
/// 1e-3 to the correlations, it is positive definite.
inline bool could_be_covariance(const Eigen::MatrixXd& given) {
  constexpr double kLost = 1e-3;
  constexpr double kLostOfLargest = 1e-12;
  Eigen::MatrixXd matrix = given;
  if (matrix.size() > 0) matrix.diagonal().array() += kLostOfLargest * matrix.diagonal().maxCoeff();
  if (!(matrix.diagonal().array() >= 0.0).all()) return false;
  const Eigen::VectorXd sd = matrix.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = (sd.array() > 0.0).select(sd.cwiseInverse(), 1.0);
  Eigen::MatrixXd correlations = scale.asDiagonal() * matrix * scale.asDiagonal();
  if (!correlations.isApprox(correlations.transpose(), kLost)) return false;
  correlations.diagonal().array() += kLost;
  return correlations.llt().info() == Eigen::Success;
}

/// @throws InvalidInput unless a covariance has this size and could be one
inline void require_covariance(const auto& covariance, Eigen::Index size) {
  require_state(covariance.rows() == size && covariance.cols() == size,
                "a covariance of the size of what it is of");
  require_state(covariance.allFinite(), "a covariance that is finite");
  require_state(could_be_covariance(covariance), "a covariance that is positive semi-definite");
}

template <LieGroup G>
struct StateFields<ConcentratedGaussian<G>> {
  using Density = ConcentratedGaussian<G>;
  using Stored = std::pair<G, typename Density::Covariance>;
  static Density blank() {
    const G mean;
    return Density::trusted(mean, Density::Covariance::Zero(mean.dof(), mean.dof()));
  }
  static Stored to_stored(const Density& x) { return {x.mean(), x.covariance()}; }
  static Density of_stored(Stored stored) {
    require_covariance(stored.second, stored.first.dof());
    return Density::trusted(std::move(stored.first), std::move(stored.second));
  }
};

}  // namespace posemix::internal
