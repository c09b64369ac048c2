// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "detection_update.hpp"
#include "posemix/density/concentrated_gaussian.hpp"
#include "posemix/lie/pose_blocks.hpp"

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
};

/// Moves the mean by [xi_O; b].
void move(ConditionalPose& object, const Vector12d& by);

/// Moments of the camera under all hypotheses of an object that do not lead, taken together, in the
/// tangent space at the camera's mean before the detection.
struct CameraAlternative {
  double weight = 0.0;  ///< their probability, w_a
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

/// Blocks of two joint Gaussians that are the same, by their index in each.
using BlockPairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// The change of the camera by a detection.
struct CameraChange {
  Vector6d mean;        ///< in the tangent space at the mean before, K z
  Matrix6d covariance;  ///< of K z
  /// Covariance of the error of every coordinate of the joint Gaussian after the detection with K
  /// z.
  Eigen::Matrix<double, Eigen::Dynamic, 6> error_covariance;
};

/// The regression of a pose and a slow error on the camera, P_OC P_CC^-1.
Matrix12x6d regression_on_camera(const Matrix12x6d& cross_covariance, const Matrix6d& camera);

/// The joint Gaussian of the camera (block 0), its motion where that is estimated, and for every
/// object with hypotheses the pose of the leading one, followed by its slow error where the
/// detector has one; with their full covariance B (docs/many-objects.md). A block has six
/// coordinates.
class JointGaussian {
 public:
  explicit JointGaussian(const ConcentratedGaussian<SE3d>& camera)
      : blocks_{{camera.mean(), {}}}, covariance_(camera.covariance()) {}

  /// Number of blocks.
  std::size_t size() const { return blocks_.size(); }
  bool is_pose(std::size_t index) const { return !blocks_[index].slow; }
  const SE3d& pose(std::size_t index) const { return blocks_[index].pose; }
  void set_pose(std::size_t index, const SE3d& pose) { blocks_[index].pose = pose; }
  const Vector6d& slow(std::size_t index) const { return blocks_[index].slow.value(); }
  Matrix6d covariance(std::size_t row, std::size_t column) const {
    return block(covariance_, row, column);
  }
  const Eigen::MatrixXd& covariance() const { return covariance_; }
  Eigen::MatrixXd& covariance() { return covariance_; }

  /// Number of blocks of the object at `index`: two with a slow error.
  std::size_t blocks_of(std::size_t index) const {
    return index + 1 < size() && !is_pose(index + 1) ? 2 : 1;
  }
  /// Pose and slow error of the object at `index`, given the camera.
  ConditionalPose conditional(std::size_t index) const;

  /// Appends an object that depends on the rest through the camera alone. Returns its index.
  std::size_t append(const ConditionalPose& object);
  /// Appends a pose that depends on nothing, with its covariance. Returns its index.
  std::size_t append(const SE3d& pose, const Matrix6d& covariance);
  /// Puts an object that depends on the rest through the camera alone at `index`.
  void replace(std::size_t index, const ConditionalPose& object);
  /// Erases the object at `index`; blocks behind it move up. The rest keeps its moments.
  void erase(std::size_t index);

  /// The rows of the object at `index`, 6 or 12 x dim.
  Eigen::MatrixXd rows_of(std::size_t index) const;
  /// The rows that an object would have that depends on the rest through the camera alone.
  Eigen::MatrixXd regressed_rows(const ConditionalPose& object) const;
  /// Replaces the object at `index` and its rows of the covariance, symmetric in its own block.
  void set_rows(std::size_t index, const SE3d& pose, const std::optional<Vector6d>& slow,
                const Eigen::MatrixXd& rows);
  /// x <- F x for the coordinates x of the object at `index`, with F of 6 or 12 rows.
  void transform(std::size_t index, const Eigen::MatrixXd& f);
  /// Moves the object at `index` and its slow error by [xi_O; b].
  void move_object(std::size_t index, const Vector12d& by);
  /// Multiplies the slow error of the object at `index` by `factor` and adds `q` to its covariance.
  void decay_slow(std::size_t index, double factor, const Matrix6d& q);

  /// A detection of the object at `index`, explained under its leading hypothesis, which holds with
  /// probability 1 - alternative.weight; otherwise the camera has the moments of `alternative`.
  /// Projects this mixture onto one Gaussian with the least loss (docs/many-objects.md, eq. 5 to
  /// 8) and moves the blocks to its mean. The gain of all but the object has the camera's
  /// factor.
  CameraChange update(std::size_t index, const Explanation& leading,
                      const CameraAlternative& alternative, const GainFactors& factors);
  /// Becomes the mixture of this with 1 - `weight` and of `other` with `weight`, eq. (11): the
  /// blocks in `shared`, by their index here and there, take its moments, and the others keep their
  /// regression on them. Returns the camera's mean in the tangent space at the mean before.
  Vector6d mix(double weight, const JointGaussian& other, const BlockPairs& shared);
  /// Takes the part `back` of the camera's correction back, see eq. (10).
  void shift_back(const CameraChange& change, const Matrix6d& back);

 private:
  struct Block {
    SE3d pose;
    std::optional<Vector6d> slow;  ///< present where the block is a slow error
  };

  /// First coordinate and number of coordinates of the object at `index`.
  Eigen::Index first(std::size_t index) const { return offset(index); }
  Eigen::Index dof(std::size_t index) const { return offset(blocks_of(index)); }
  /// P H^T of a detection of the object at `index` under one component.
  Eigen::MatrixXd times_ht(std::size_t index, const Matrix6d& slow_map) const;
  /// Projects the mixture of the moments (`mean`, `b`) of the leading hypothesis and (`mean` +
  /// `apart`, `other`) with weight `w_a` (eq. 7 and 8). `mean` becomes that of the projection.
  void project(std::size_t index, double w_a, Eigen::VectorXd& mean, const Eigen::MatrixXd& b,
               const Eigen::VectorXd& apart, const Eigen::MatrixXd& other);
  /// The means of `other` in the tangent space at those of this, for the blocks in `shared`.
  Eigen::VectorXd difference(const JointGaussian& other, const BlockPairs& shared) const;
  /// The coordinates `s` get moments, and the others keep their regression on them. Returns the
  /// mean of all.
  Eigen::VectorXd regressed_on(const std::vector<Eigen::Index>& s, const Eigen::VectorXd& mean_s,
                               const Eigen::MatrixXd& covariance_s);
  /// Moves every block by its part of `mean`. Returns the camera's part.
  Vector6d move(const Eigen::VectorXd& mean);

  std::vector<Block> blocks_;
  Eigen::MatrixXd covariance_;
};

}  // namespace posemix::internal
