// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/kept_matrices.hpp"
#include "detection_update.hpp"
#include "filter/world_shift.hpp"
#include "posemix/lie/pose_blocks.hpp"

/// What goes into the joint Gaussian and comes out of it.
namespace posemix::internal {

using Matrix12d = Eigen::Matrix<double, 12, 12>;
using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12x6d = Eigen::Matrix<double, 12, 6>;

/// The pose of an object under one hypothesis, X = Exp(xi_O) X0, and the slow error b of its
/// detector, given the camera.
struct ConditionalPose {
  SE3d pose;                          ///< T_world_object
  std::optional<Vector6d> slow = {};  ///< mean of b; none for a detector without a slow error
  Matrix12d covariance;               ///< of [xi_O; b], world frame
  Matrix12x6d cross_covariance;       ///< Cov([xi_O; b], xi_C)
  /// Cov([xi_O; b], [xi_E ...]) with the extrinsics that are estimated, six columns each.
  Eigen::Matrix<double, 12, Eigen::Dynamic> extrinsics = {};

  /// The camera's coordinates become xi_C + by xi_E with the extrinsic of that block.
  void add_extrinsic_to_camera(std::size_t block, const Matrix6d& by) {
    cross_covariance += extrinsics.middleCols<6>(offset(block) - kPoseDof) * by.transpose();
  }
};

/// Moves the mean by [xi_O; b].
void move(ConditionalPose& object, const Vector12d& by);

/// Appends the six coordinates from `first` on.
inline void append_coordinates(std::vector<Eigen::Index>& coordinates, Eigen::Index first) {
  for (Eigen::Index k = 0; k < kPoseDof; ++k) coordinates.push_back(first + k);
}

/// Moments of the camera under all hypotheses of an object that do not lead, taken together, in the
/// tangent space at the camera's mean before the detection.
struct CameraAlternative {
  double weight = 0.0;  ///< their probability, w_a
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  RigMoments rig = {};
};

/// Blocks of two joint Gaussians that are the same, by their index in each.
using BlockPairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// The coordinates x of a block become own x + other x_beside, where `beside` is another block.
struct BlockCoordinates {
  std::size_t block = 0;
  Matrix6d own = Matrix6d::Identity();
  std::size_t beside = 0;
  Matrix6d other = Matrix6d::Zero();
};

/// Second moments of a pose.
struct PoseMoments {
  Matrix6d covariance;        ///< Cov(xi)
  Matrix6d cross_covariance;  ///< Cov(xi, xi_C)
};

/// The change of the camera by a detection.
struct CameraChange {
  Vector6d mean;        ///< in the tangent space at the mean before, K z
  Matrix6d covariance;  ///< of K z
  /// Covariance of the error of every coordinate of the joint Gaussian after the detection with K
  /// z.
  KeptMatrix<6> error_covariance;
  /// Mean of [xi_C; xi_E ...]; empty where all cameras are exact.
  Eigen::VectorXd rig_mean = {};
};

/// The regression of a pose and a slow error on the camera, P_OC P_CC^-1.
Matrix12x6d regression_on_camera(const Matrix12x6d& cross_covariance, const Matrix6d& camera);
/// The same on the camera and the extrinsics, 12 rows.
Eigen::MatrixXd regression_on_rig(const ConditionalPose& object, const Eigen::MatrixXd& rig);

/// How a shift of the world moves every block of a joint Gaussian.
using WorldMoves = KeptVector<Matrix6d>;

/// Six columns of a covariance.
using SixColumns = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// Bases and the columns of carriers that joint Gaussians share, before and after a move of the
/// world.
struct MovedBases {
  template <class Matrix>
  using Pair = std::pair<std::shared_ptr<const Matrix>, std::shared_ptr<const Matrix>>;

  std::map<const Eigen::MatrixXd*, std::set<Eigen::Index>> pose_rows;  ///< of each base
  std::vector<Pair<Eigen::MatrixXd>> bases = {};
  std::vector<Pair<SixColumns>> columns = {};
};

}  // namespace posemix::internal
