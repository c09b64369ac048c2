// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <vector>

#include "base/cholesky6.hpp"
#include "joint_gaussian.hpp"

namespace posemix::internal {

/// Cholesky factor of a covariance of blocks of six coordinates of which rounding may have left
/// little: that of a map that is certain in itself and not of where it is. Where the correlations
/// between the blocks are nearly singular, whatever the units and wherever the origin, the
/// covariance of every block is larger by a part of itself, 1e-9 if that is enough.
class RegularFactor {
 public:
  explicit RegularFactor(const Eigen::MatrixXd& covariance);

  /// P^-1 X.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& columns) const;
  /// Makes the blocks on the diagonal of a covariance larger by the same part.
  void add_to(Eigen::MatrixXd& covariance) const;

 private:
  std::vector<Cholesky6> blocks_;
  Eigen::LLT<Eigen::MatrixXd> correlation_;  ///< of the blocks, whitened by their own factors
  double added_ = 0.0;
};

/// Whether a pose that a regression moves, to this covariance, is still a pose: a regression on a
/// camera that is nearly certain takes poses that are not anywhere, once the camera is found to be
/// elsewhere.
bool is_rotation(const Vector6d& moved, const Matrix6d& covariance);

/// Eq. (9) of docs/many-objects.md: poses follow the camera, and the extrinsics of its rig, whose
/// moments change from `before` to `after`, by their regression on them. Both must live as long.
class CameraRegression {
 public:
  CameraRegression(const CameraMoments& before, const CameraMoments& after);

  void carry(ConditionalPose& pose) const;

 private:
  void carry_with_rig(ConditionalPose& pose) const;
  /// Where the regression does not hold the pose stays as it is, with the covariance
  /// P_OC (P + P')^-1 P' with the camera, which is positive definite with any P'.
  void loosen(ConditionalPose& pose) const;

  const CameraMoments& before_;
  const CameraMoments& after_;
  Cholesky6 camera_;       ///< of the covariance before, without extrinsics
  Eigen::VectorXd shift_;  ///< P^-1 (m' - m), with extrinsics
  /// L with P' = P - L L^T, and P^-1 L. An observation under one hypothesis changes the rig in six
  /// directions alone; without columns P' is another one, and `solved_` is empty.
  Eigen::MatrixXd reduction_;
  Eigen::MatrixXd solved_;
};

}  // namespace posemix::internal
