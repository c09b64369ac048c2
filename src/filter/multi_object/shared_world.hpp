// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "base/cholesky6.hpp"
#include "joint_gaussian.hpp"

namespace posemix::internal {

/// The error of the world, a shift w of covariance W that camera and objects share, of which no
/// detection tells: eq. (31) of docs/many-objects.md. Without it an object follows what is left of
/// the camera's error, xi_O - w = G (xi_C - w) + e, so that G = (P_OC - W) (P_CC - W)^-1; with
/// extrinsics what is left of [xi_C; xi_E ...].
class SharedWorld {
 public:
  /// Nothing is shared without a covariance of the world, or where next to nothing is left of the
  /// camera's.
  SharedWorld(const std::optional<WorldError>& world, const CameraMoments& camera);

  const Matrix6d& covariance() const { return world_; }
  /// G for a pose and its slow error, without extrinsics. None where the pose does not share the
  /// error of the world: it was seen by a camera whose pose was given, or is known in the world
  /// better than the camera.
  std::optional<Matrix12x6d> regression(const ConditionalPose& object) const;
  /// The same with extrinsics, 12 rows.
  std::optional<Eigen::MatrixXd> regression_on_rig(const ConditionalPose& object) const;

 private:
  bool is_shared(const ConditionalPose& object) const;

  Matrix6d world_ = Matrix6d::Zero();
  Matrix6d local_;
  Eigen::MatrixXd local_rig_;
  std::optional<Cholesky6> world_factor_;
  std::optional<Cholesky6> local_factor_;
  std::optional<Eigen::LLT<Eigen::MatrixXd>> rig_factor_;
};

}  // namespace posemix::internal
