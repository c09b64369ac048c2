// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/density/operations.hpp"

#include <numbers>

#include <Eigen/Eigenvalues>

namespace posemix {
namespace internal {
namespace {

constexpr double kNear = 0.25 * std::numbers::pi;  ///< turn between means with one mode [rad]
constexpr double kWide = 0.35;  ///< standard deviation of rotation with modes of its own [rad]

/// Half way by the longer turn about the same axis, and to the translation half way.
SE3d middle_of_longer_way(const SE3d& from, const SE3d& to) {
  SE3d::Tangent half = 0.5 * (to * from.inverse()).log();
  half.head<3>() -= std::numbers::pi * half.head<3>().normalized();
  return SE3d::exp(half) * from;
}

/// Half turns of a pose, in its place, about the principal axes of a covariance of rotation that is
/// wide.
void add_half_turns(const SE3d& pose, const Eigen::Matrix3d& covariance,
                    std::vector<SE3d>& starts) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  if (eigen.eigenvalues()[2] < kWide * kWide) return;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const SO3d turn = SO3d::exp(std::numbers::pi * eigen.eigenvectors().col(i));
    starts.emplace_back(turn * pose.rotation(), pose.translation());
  }
}

std::vector<SE3d> other_starts(const SE3d& p, const Eigen::Matrix3d& covariance_p, const SE3d& q,
                               const Eigen::Matrix3d& covariance_q) {
  if (!((q.rotation() * p.rotation().inverse()).angle() > kNear)) return {};
  std::vector<SE3d> starts{middle_of_longer_way(p, q)};
  add_half_turns(p, covariance_p, starts);
  add_half_turns(q, covariance_q, starts);
  return starts;
}

}  // namespace

std::vector<SE3d> other_starts(const ConcentratedGaussian<SE3d>& p,
                               const ConcentratedGaussian<SE3d>& q) {
  return other_starts(p.mean(), p.covariance().topLeftCorner<3, 3>(), q.mean(),
                      q.covariance().topLeftCorner<3, 3>());
}

std::vector<SO3d> other_starts(const ConcentratedGaussian<SO3d>& p,
                               const ConcentratedGaussian<SO3d>& q) {
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<SO3d> starts;
  for (const SE3d& start :
       other_starts(SE3d(p.mean(), origin), p.covariance(), SE3d(q.mean(), origin), q.covariance()))
    starts.push_back(start.rotation());
  return starts;
}

}  // namespace internal

POSEMIX_DENSITY_OPERATIONS(, SO3d);
POSEMIX_DENSITY_OPERATIONS(, SE3d);
POSEMIX_DENSITY_OPERATIONS(, PoseStackd);
POSEMIX_DENSITY_OPERATIONS(, Rnd<3>);

}  // namespace posemix
