// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "shared_world.hpp"

namespace posemix::internal {
namespace {

/// What is left of the camera's variance without the world's, below which it is rounding.
constexpr double kLeastLocal = 1e-9;

/// Of the six coordinates of the world so many must be in the pose's covariance with the camera.
constexpr double kLeastShared = 5.0;

/// The bound on |L^-1 G L| with P_CC - W = L L^T: six for a pose that has all of what is left of
/// the camera's error. More is the error of W beside the little that is left.
constexpr double kMostFollowed = 9.0;

bool is_covariance(const Matrix12d& p, bool has_slow) {
  return has_slow ? Eigen::LLT<Matrix12d>(p).info() == Eigen::Success
                  : Cholesky6(Matrix6d(p.topLeftCorner<6, 6>())).ok();
}

}  // namespace

SharedWorld::SharedWorld(const std::optional<WorldError>& world, const CameraMoments& camera) {
  if (!world) return;
  world_ = world->covariance;
  local_ = camera.covariance - world_;
  const Cholesky6 local(local_);
  const Vector6d left =
      local.factor().diagonal().cwiseAbs2().cwiseQuotient(camera.covariance.diagonal());
  const Cholesky6 factor(world_);
  if (!local.ok() || !factor.ok() || left.minCoeff() < kLeastLocal) return;
  if (!camera.rig.empty()) {
    local_rig_ = camera.rig.covariance;
    local_rig_.topLeftCorner<6, 6>() -= world_;
    rig_factor_.emplace(local_rig_);
    if (rig_factor_->info() != Eigen::Success) return;
  }
  local_factor_ = local;
  world_factor_ = factor;
}

bool SharedWorld::is_shared(const ConditionalPose& object) const {
  if (!local_factor_) return false;
  const Matrix6d cross = object.cross_covariance.topRows<6>();
  const Matrix6d shared = world_factor_->whitened_rows(cross);
  if (world_factor_->whitened_rows(Matrix6d(shared.transpose())).trace() < kLeastShared)
    return false;
  const Matrix6d following = local_factor_->whitened_rows(Matrix6d(cross - world_));
  return local_factor_->whitened_rows(Matrix6d(following.transpose())).squaredNorm() <
         kMostFollowed;
}

std::optional<Matrix12x6d> SharedWorld::regression(const ConditionalPose& object) const {
  if (!is_shared(object)) return std::nullopt;
  Matrix12x6d following = object.cross_covariance;
  following.topRows<6>() -= world_;
  const Matrix12x6d by = local_factor_->solved_rows(following);
  // The covariance of e.
  Matrix12d own = object.covariance - by * local_ * by.transpose();
  own.topLeftCorner<6, 6>() -= world_;
  return is_covariance(own, object.slow.has_value()) ? std::optional(by) : std::nullopt;
}

std::optional<Eigen::MatrixXd> SharedWorld::regression_on_rig(const ConditionalPose& object) const {
  if (!is_shared(object) || !rig_factor_) return std::nullopt;
  Eigen::MatrixXd following(12, local_rig_.cols());
  following << object.cross_covariance, object.extrinsics;
  following.topLeftCorner<6, 6>() -= world_;
  const Eigen::MatrixXd by = rig_factor_->solve(following.transpose()).transpose();
  Matrix12d own = object.covariance - by * local_rig_ * by.transpose();
  own.topLeftCorner<6, 6>() -= world_;
  return is_covariance(own, object.slow.has_value()) ? std::optional(by) : std::nullopt;
}

}  // namespace posemix::internal
