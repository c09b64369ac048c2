// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>

#include "posemix/detector/symmetry.hpp"
#include "posemix/slam/frame_estimate.hpp"

/// The part of a pose's error that can be observed on an object with symmetries.
namespace posemix {

/// An error and its covariance along some directions.
struct ObservedPart {
  Eigen::VectorXd error;
  Eigen::MatrixXd covariance;

  /// e^T P^-1 e: chi-square with error.size() degrees of freedom when consistent; zero without any,
  /// NaN when the covariance is not positive definite.
  double nees() const;
  /// The error with unit covariance: C^-1/2 D^-1 e for P = D C D with the correlations C and
  /// standard deviations D. Its squared norm is nees().
  Eigen::VectorXd whitened() const;
};

/// An error of a pose along the axes of the estimate, e with T_true = T_est Exp(e), the truth being
/// the nearest of its symmetric images. Rotation first; radians, metres.
struct ObservedError {
  ObservedPart pose;
  ObservedPart rotation;
  ObservedPart position;
  /// The same error with all six coordinates: what cannot be observed is zero in both.
  Vector6d error;
  Matrix6d covariance;
};

/// Compares estimates with the truth as far as the symmetries of an object let it be seen.
///
/// The nearest of the equivalent truths in terms of rotation^2 + (translation / 0.1 m)^2 counts;
/// the covariance has no part in the choice. Under turns about an axis the rotation about it leaves
/// the degrees of freedom (5 in all, 2 of rotation), under all turns about a point the whole
/// rotation (3 and 0); the position is that of the axis' point next to the object's origin, or of
/// the common point of the axes. Without symmetries all six count, at the object's origin.
class ErrorReduction {
 public:
  explicit ErrorReduction(const SymmetryGroup& symmetries = {});

  std::size_t dof() const { return 3 + rotation_dof(); }
  std::size_t rotation_dof() const { return static_cast<std::size_t>(rotation_.cols()); }
  const SymmetryGroup& symmetries() const { return symmetries_; }

  /// The equivalent truth that is nearest to the estimate; without symmetries the truth itself.
  SE3d nearest(const SE3d& truth, const SE3d& estimate) const;
  /// The error of an estimate.
  ObservedError operator()(const PoseDensity& estimate, const SE3d& truth) const;
  /// e^T P^-1 e: chi-square with dof() degrees of freedom when the estimate is consistent.
  double nees(const PoseDensity& estimate, const SE3d& truth) const;
  /// Covariance of the rotation along the directions that can be observed [rad^2], 0 x 0 to 3 x 3.
  Eigen::MatrixXd rotation_covariance(const PoseDensity& estimate) const;

 private:
  SymmetryGroup symmetries_;
  Eigen::Vector3d point_ = Eigen::Vector3d::Zero();
  /// Orthonormal directions of the rotations that can be observed: 3 x 3, 3 x 2 or 3 x 0.
  Eigen::Matrix<double, 3, Eigen::Dynamic> rotation_;
};

}  // namespace posemix
