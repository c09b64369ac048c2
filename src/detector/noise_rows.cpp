// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "detector/noise_rows.hpp"

#include <cmath>
#include <numbers>

namespace posemix::internal {

double log_uniform(double volume_m3) {
  return -std::log(8.0 * std::numbers::pi * std::numbers::pi * volume_m3);
}

Eigen::ArrayXd log_sum_exp_of_rows(const Eigen::ArrayXXd& terms) {
  const Eigen::ArrayXd largest = terms.rowwise().maxCoeff();
  return largest + (terms.colwise() - largest).exp().rowwise().sum().log();
}

Matrix6d residual_turn(const SE3d& camera_mode, NoiseFrame frame) {
  Matrix6d turn = Matrix6d::Identity();
  if (frame == NoiseFrame::object) return turn;
  Eigen::Matrix3d rotation = camera_mode.rotation().matrix();
  double unit = 1.0;
  if (frame == NoiseFrame::ray) {
    const ViewingRay ray = viewing_ray(camera_mode);
    rotation = ray.axes.matrix().transpose() * rotation;
    unit = ray.range;
  }
  turn.topLeftCorner<3, 3>() = rotation;
  turn.bottomRightCorner<3, 3>() = rotation / unit;
  return turn;
}

ResidualRows::ResidualRows(std::span<const NoiseObservation> observations, NoiseFrame frame,
                           const SE3d& offset)
    : residuals_(6, static_cast<Eigen::Index>(observations.size())),
      log_volume_(residuals_.cols()) {
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const SE3d mode = observations[i].truth * offset;
    const Vector6d n = detection_residual(mode, observations[i].detected, frame);
    residuals_.col(at) = n;
    log_volume_[at] = SE3d::log_abs_det_left_jacobian(n);
    if (frame == NoiseFrame::ray) log_volume_[at] += 3.0 * std::log(viewing_ray(mode).range);
  }
}

Eigen::ArrayXd ResidualRows::log_density(const Matrix6d& covariance) const {
  const Eigen::LLT<Matrix6d> factor(covariance);
  const Matrix6d whitening = factor.matrixL().solve(Matrix6d::Identity());
  const Eigen::ArrayXd squared = (whitening * residuals_).colwise().squaredNorm().transpose();
  return -0.5 * (squared + log_det(factor) + 6.0 * kLogTwoPi) - log_volume_;
}

Matrix6d ResidualRows::second_moment(const Eigen::Ref<const Eigen::ArrayXd>& shares) const {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> shared = residuals_ * shares.matrix().asDiagonal();
  Matrix6d moment = shared * residuals_.transpose();
  symmetrize(moment);
  return moment;
}

}  // namespace posemix::internal
