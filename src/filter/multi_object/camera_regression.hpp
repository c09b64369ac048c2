// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "base/cholesky6.hpp"
#include "joint_gaussian.hpp"
#include "shared_world.hpp"

namespace posemix::internal {

/// Cholesky factor of a covariance of which rounding may have left little: that of a map that is
/// certain in itself and not of where it is. Where the covariance is nearly singular the variances
/// are larger by a part `added` of themselves, 1e-9 if that is enough, which the caller adds to
/// what it takes the factor of.
struct RegularFactor {
  explicit RegularFactor(const Eigen::MatrixXd& covariance);

  Eigen::LLT<Eigen::MatrixXd> factor;
  double added = 0.0;
};

/// Whether a pose that a regression moves, to this covariance, is still a pose: a regression on a
/// camera that is nearly certain takes poses that are not anywhere, once the camera is found to be
/// elsewhere.
bool is_rotation(const Vector6d& moved, const Matrix6d& covariance);

/// The error of the world before and after a change of the camera, of which it tells nothing.
struct WorldChange {
  std::optional<WorldError> before;
  std::optional<WorldError> after;
};

/// Eq. (9) and (31) of docs/many-objects.md: poses follow the camera, and the extrinsics of its
/// rig, whose moments change from `before` to `after`, by their regression on them. Both must live
/// as long.
class CameraRegression {
 public:
  /// Poses that share the error of the world keep it. Without `world` they follow the camera alone.
  CameraRegression(const CameraMoments& before, const CameraMoments& after,
                   const WorldChange& world = {});

  void carry(ConditionalPose& pose) const;

 private:
  void carry_with_rig(ConditionalPose& pose) const;
  /// False, and nothing has changed, where the pose does not share the error of the world.
  bool carry_with_world(ConditionalPose& pose) const;
  bool carry_with_rig_and_world(ConditionalPose& pose) const;
  bool is_sound(const Matrix12d& own, const Matrix12x6d& cross) const;
  /// Where the regression does not hold the pose stays as it is, with the covariance
  /// P_OC (P + P')^-1 P' with the camera, which is positive definite with any P'.
  void loosen(ConditionalPose& pose) const;

  const CameraMoments& before_;
  const CameraMoments& after_;
  Cholesky6 camera_;  ///< of the covariance before, without extrinsics
  SharedWorld shared_;
  std::optional<Matrix6d> world_after_;
  Eigen::VectorXd shift_;  ///< P^-1 (m' - m), with extrinsics
  /// L with P' = P - L L^T, and P^-1 L. An observation under one hypothesis changes the rig in six
  /// directions alone; without columns P' is another one, and `solved_` is empty.
  Eigen::MatrixXd reduction_;
  Eigen::MatrixXd solved_;
};

}  // namespace posemix::internal
