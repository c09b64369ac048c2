// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pair.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/lie/pose_blocks.hpp"

namespace posemix::internal {

/// Moments of the camera under all hypotheses of an object that do not lead, taken together, in the
/// tangent space at the camera's mean before the detection.
struct CameraAlternative {
  double weight = 0.0;  ///< their probability, w_a
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

/// The regression of a pose on the camera, P_OC P_CC^-1.
Matrix6d regression_on_camera(const Matrix6d& cross_covariance, const Matrix6d& camera);

/// The joint Gaussian of the camera (pose 0), its motion where that is estimated, and the leading
/// hypothesis of every object, with their full covariance B (docs/many-objects.md).
class JointGaussian {
 public:
  explicit JointGaussian(const ConcentratedGaussian<SE3d>& camera)
      : poses_{camera.mean()}, covariance_(camera.covariance()) {}

  std::size_t size() const { return poses_.size(); }
  const SE3d& pose(std::size_t index) const { return poses_[index]; }
  void set_pose(std::size_t index, const SE3d& pose) { poses_[index] = pose; }
  Matrix6d covariance(std::size_t row, std::size_t column) const {
    return block(covariance_, row, column);
  }
  const Eigen::MatrixXd& covariance() const { return covariance_; }
  Eigen::MatrixXd& covariance() { return covariance_; }

  /// The camera and the object at index `object`.
  Pair pair(std::size_t object) const;

  /// The rows of the covariance at `index`, 6 x dim.
  Eigen::MatrixXd rows_of(std::size_t index) const;

  /// The rows of a pose that is not in the joint Gaussian and depends on it through the camera
  /// alone, from its cross-covariance with the camera.
  Eigen::MatrixXd regressed_rows(const Matrix6d& cross_covariance) const;

  /// Appends a pose that depends on the others through the camera alone, given its covariance and
  /// its cross-covariance with the camera (rows of the new pose). Returns its index.
  std::size_t append(const SE3d& pose, const Matrix6d& covariance,
                     const Matrix6d& cross_covariance);

  /// Puts such a pose in place of the one at `index`.
  void replace(std::size_t index, const SE3d& pose, const Matrix6d& covariance,
               const Matrix6d& cross_covariance);

  /// Erases the pose at `index`; those behind it move up. The rest keeps its moments.
  void erase(std::size_t index);

  /// Replaces the pose at `index` and its rows of the covariance, 6 x dim, symmetric in the block
  /// at `index`.
  void set_rows(std::size_t index, const SE3d& pose, const Eigen::MatrixXd& rows);

  /// A detection of the object at `index`. The camera and the leading hypothesis have the moments
  /// `leading` with probability 1 - alternative.weight; otherwise the camera has those of
  /// `alternative`. Projects this mixture onto one Gaussian with the least loss
  /// (docs/many-objects.md, eq. 5 to 8) and moves the poses to its mean. Returns the mean of the
  /// camera in the tangent space before.
  Vector6d update(std::size_t index, const PairMoments& leading,
                  const CameraAlternative& alternative);

 private:
  /// Moments of all poses when those of the poses at `indices` are given and the others follow by
  /// regression on them (eq. 5 and 6).
  void regress(std::span<const std::size_t> indices, const Eigen::VectorXd& mean,
               const Eigen::MatrixXd& covariance, Eigen::VectorXd& all_mean,
               Eigen::MatrixXd& all_covariance) const;
  /// Projects the mixture of the moments (`mean`, `b`) of the leading hypothesis and (`mean` +
  /// `apart`, `other`) with weight `w_a` (eq. 7 and 8). `mean` becomes that of the projection.
  void project(std::size_t index, double w_a, Eigen::VectorXd& mean, const Eigen::MatrixXd& b,
               const Eigen::VectorXd& apart, const Eigen::MatrixXd& other);
  /// Moves every pose by its part of `mean`. Returns the camera's part.
  Vector6d move(const Eigen::VectorXd& mean);

  std::vector<SE3d> poses_;
  Eigen::MatrixXd covariance_;
};

}  // namespace posemix::internal
