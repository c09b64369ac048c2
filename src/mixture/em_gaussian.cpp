// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/mixture/em_gaussian.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kDof = 6;

/// sum r a x b from sum r a b^T.
Eigen::Vector3d cross_of(const Eigen::Matrix3d& outer) {
  return {outer(1, 2) - outer(2, 1), outer(2, 0) - outer(0, 2), outer(0, 1) - outer(1, 0)};
}

}  // namespace

EmGaussianWorker<SE3d>::EmGaussianWorker(const Density& density, const EmSettings& settings)
    : density_(density), settings_(&settings), kernel_(kernel_of(density)), rows_(kPoseRows) {}

void EmGaussianWorker<SE3d>::log_density(const Samples& samples, std::size_t begin,
                                         std::size_t count, EmRow& out) {
  count_ = count;
  pose_log_density(samples.block(begin), count, kernel_, rows_.data(), out);
}

void EmGaussianWorker<SE3d>::accumulate(const EmRow& shares) {
  add_moments(kDof, rows_.data(), shares, count_, sums_.data());
  if (!settings_->fixed_means) {
    add_pose_gradient(rows_.data(), shares, count_, kernel_, gradient_.data());
  }
}

EmGaussianMoments<SE3d> EmGaussianWorker<SE3d>::moments() const {
  EmGaussianMoments<SE3d> moments(kDof);
  moments.weight = sums_.total(0);
  for (std::size_t i = 0; i < kDof; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    moments.first[row] = sums_.total(1 + i);
    for (std::size_t j = 0; j <= i; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      moments.second(row, column) = sums_.total(em_second_moment(kDof, i, j));
      moments.second(column, row) = moments.second(row, column);
    }
  }
  moments.gradient = gradient(moments);
  return moments;
}

/// sum r (J_r^-T y + grad log |det J_l|) with y = P^-1 xi = [y1; y2]. The terms y and -(phi x y1 +
/// rho x y2, phi x y2) / 2 follow from the moments, the others from add_pose_gradient.
Vector6d EmGaussianWorker<SE3d>::gradient(const EmGaussianMoments<SE3d>& moments) const {
  Matrix6d precision;
  Vector6d sums, with_y, with_y2;
  for (std::size_t i = 0; i < kDof; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    precision.row(row) = Vector6d::Map(kernel_.precision[i].data());
    sums[row] = gradient_.total(i);
    with_y[row] = gradient_.total(kDof + i);
    with_y2[row] = gradient_.total(2 * kDof + i);
  }
  const Matrix6d xi_y = moments.second * precision;  // sum r xi y^T
  Vector6d gradient = sums + precision * (moments.first - with_y);
  gradient.head<3>() -=
      0.5 * (cross_of(xi_y.topLeftCorner<3, 3>()) + cross_of(xi_y.bottomRightCorner<3, 3>())) +
      precision.bottomRows<3>() * with_y2;
  gradient.tail<3>() -= 0.5 * cross_of(xi_y.topRightCorner<3, 3>());
  return gradient;
}

ConcentratedGaussian<SE3d> EmGaussianWorker<SE3d>::update(double step) const {
  return moments().update(density_, *settings_, step);
}

}  // namespace posemix::internal
