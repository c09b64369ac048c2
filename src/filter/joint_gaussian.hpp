// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pair.hpp"
#include "pose_blocks.hpp"
#include "posemix/density/concentrated_gaussian.hpp"

/// Camera and leading hypotheses with their full covariance (docs/many-objects.md). In the room
/// `filter` only.
namespace posemix::internal {

/// Moments of the camera under hypotheses that do not lead, taken together.
struct CameraAlternative {
  double weight = 0.0;
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

/// The joint Gaussian of camera (pose 0), further poses of its motion, and one pose per object.
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

  Pair pair(std::size_t object) const;

  /// Appends a pose that depends on the others through the camera alone: its covariance, and that
  /// with the camera (rows of the new pose). Returns its index.
  std::size_t append(const SE3d& pose, const Matrix6d& covariance,
                     const Matrix6d& cross_covariance);

  /// The same in place of the pose at `index`.
  void replace(std::size_t index, const SE3d& pose, const Matrix6d& covariance,
               const Matrix6d& cross_covariance);

  /// Drops the pose at `index`; those behind it move up. What is left keeps its moments.
  void erase(std::size_t index);

  /// The pose at `index` with its rows, of which the block at `index` itself is not looked at.
  void set_rows(std::size_t index, const SE3d& pose, const Eigen::MatrixXd& rows,
                const Matrix6d& covariance);

  /// A detection of the object at `index`: `leading` with probability 1 - alternative.weight are
  /// the moments of camera and leading hypothesis, `alternative` those of the camera otherwise.
  /// Projects onto one Gaussian whose loss is least (docs/many-objects.md, eq. 5 to 9) and moves
  /// the poses. Returns how the camera was moved.
  Vector6d update(std::size_t index, const PairMoments& leading,
                  const CameraAlternative& alternative);

  /// The same where the object has no pose here: only the camera's alternatives speak.
  Vector6d update_camera(const CameraAlternative& camera);

 private:
  /// Moments of everything when those of the poses at `indices` are given and everything else
  /// follows by regression on them.
  void regress(std::span<const std::size_t> indices, const Eigen::VectorXd& mean,
               const Eigen::MatrixXd& covariance, Eigen::VectorXd& all_mean,
               Eigen::MatrixXd& all_covariance) const;
  /// The covariance of the mixture of moments (`mean`, `b`), of the leading hypothesis, and
  /// (`mean` + `apart`, `other`) with weight `w_a`, projected; `mean` becomes that of the mixture.
  void project(std::size_t index, double w_a, Eigen::VectorXd& mean, const Eigen::MatrixXd& b,
               const Eigen::VectorXd& apart, const Eigen::MatrixXd& other);
  Vector6d move(const Eigen::VectorXd& mean);

  std::vector<SE3d> poses_;
  Eigen::MatrixXd covariance_;
};

}  // namespace posemix::internal
