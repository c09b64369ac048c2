// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "joint_gaussian.hpp"

namespace posemix::internal {

/// Eq. (9) of docs/many-objects.md: poses follow the camera, and the extrinsics of its rig, whose
/// moments change from `before` to `after`, by their regression on them. Both must live as long.
class CameraRegression {
 public:
  CameraRegression(const CameraMoments& before, const CameraMoments& after);

  void carry(ConditionalPose& pose) const;

 private:
  void carry_with_rig(ConditionalPose& pose) const;

  const CameraMoments& before_;
  const CameraMoments& after_;
  Eigen::LLT<Matrix6d> camera_;  ///< of the covariance before, without extrinsics
  Eigen::VectorXd shift_;        ///< P^-1 (m' - m), with extrinsics
  /// L with P' = P - L L^T, and P^-1 L. An observation under one hypothesis changes the rig in six
  /// directions alone; without columns P' is another one, and `solved_` is empty.
  Eigen::MatrixXd reduction_;
  Eigen::MatrixXd solved_;
};

}  // namespace posemix::internal
