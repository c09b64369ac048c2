// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/detector/noise_observation.hpp"

/// Residuals of many detections, as fits need them.
namespace posemix::internal {

/// Log of the density that is uniform over all rotations and a volume.
double log_uniform(double volume_m3);

/// log(sum(exp)) of every row.
Eigen::ArrayXd log_sum_exp_of_rows(const Eigen::ArrayXXd& terms);

/// The matrix that takes a residual along the axes of the mode T_camera_mode to one along those of
/// the frame.
Matrix6d residual_turn(const SE3d& camera_mode, NoiseFrame frame);

/// The residuals of observations about one mode, one column each.
class ResidualRows {
 public:
  ResidualRows(std::span<const NoiseObservation> observations, NoiseFrame frame,
               const SE3d& offset);

  const Eigen::Matrix<double, 6, Eigen::Dynamic>& residuals() const { return residuals_; }
  /// Log density of every detection for this covariance [rad^-3 m^-3].
  Eigen::ArrayXd log_density(const Matrix6d& covariance) const;
  /// The sum of share n n^T.
  Matrix6d second_moment(const Eigen::Ref<const Eigen::ArrayXd>& shares) const;

 private:
  Eigen::Matrix<double, 6, Eigen::Dynamic> residuals_;
  Eigen::ArrayXd log_volume_;  ///< log of the Haar volume of a unit of volume of the residual
};

}  // namespace posemix::internal
