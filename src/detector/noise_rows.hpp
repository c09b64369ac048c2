// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>

#include "posemix/detector/noise_fit.hpp"

/// Residuals of many detections, for fits.
namespace posemix {

/// Log of the density that is uniform over all rotations and a volume.
double log_uniform(double volume_m3);

/// log sum exp of every row.
Eigen::ArrayXd log_sum_exp_of_rows(const Eigen::ArrayXXd& terms);

/// What turns a residual along the axes of the mode T_camera_mode into one along those of the
/// frame.
Matrix6d residual_turn(const SE3d& camera_mode, NoiseFrame frame);

/// The residuals of observations about one mode, a column each.
class ResidualRows {
 public:
  ResidualRows(std::span<const NoiseObservation> observations, NoiseFrame frame,
               const SE3d& offset);

  const Eigen::Matrix<double, 6, Eigen::Dynamic>& residuals() const { return residuals_; }
  /// Log density of every detection for this covariance [rad^-3 m^-3].
  Eigen::ArrayXd log_density(const Matrix6d& covariance) const;
  /// sum share n n^T.
  Matrix6d second_moment(const Eigen::Ref<const Eigen::ArrayXd>& shares) const;

 private:
  Eigen::Matrix<double, 6, Eigen::Dynamic> residuals_;
  Eigen::ArrayXd log_volume_;  ///< of the residual's unit of volume on the group
};

}  // namespace posemix
