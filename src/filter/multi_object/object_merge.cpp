// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_merge.hpp"

#include <algorithm>

#include "posemix/mixture/log_weights.hpp"

namespace posemix::internal {

bool agree(const Matrix6d& camera, const SymmetryGroup& symmetries, const MergeBounds& bounds,
           const ConditionalPose& a, ConditionalPose& b) {
  const auto seen_from_camera = [&](const ConditionalPose& object) {
    return Matrix6d(object.covariance + camera - object.cross_covariance -
                    object.cross_covariance.transpose());
  };
  if ((a.pose.translation() - b.pose.translation()).norm() > bounds.translation_m) return false;
  if (!symmetries.is_trivial()) b.pose = symmetries.closest(b.pose, a.pose, Matrix6d::Identity());
  if ((a.pose.rotation().inverse() * b.pose.rotation()).log().norm() > bounds.rotation_rad)
    return false;
  const Eigen::LLT<Matrix6d> mean(0.5 * (seen_from_camera(a) + seen_from_camera(b)));
  const Vector6d z = (b.pose * a.pose.inverse()).log();
  return mean.matrixL().solve(z).squaredNorm() < bounds.squared_distance;
}

Standing merged(const Standing& a, const Standing& b) {
  const double weights[] = {a.log_weight, b.log_weight};
  Standing result = a.log_weight >= b.log_weight ? a : b;
  result.log_weight = log_sum_exp(weights);
  result.score = std::max(a.score, b.score);
  result.detections = std::max(a.detections, b.detections);
  return result;
}

Midway::Midway(const ConditionalPose& a, double log_weight_a, const ConditionalPose& b,
               double log_weight_b) {
  share_b_ = 1.0 / (1.0 + std::exp(log_weight_a - log_weight_b));
  share_a_ = 1.0 - share_b_;
  const Vector6d distance = (b.pose * a.pose.inverse()).log();
  mean_a_ = -share_b_ * distance;
  mean_b_ = share_a_ * distance;
  pose_ = SE3d::exp(-mean_a_) * a.pose;
  transport_a_ = SE3d::left_jacobian_inverse(mean_a_);
  transport_b_ = SE3d::left_jacobian_inverse(mean_b_);
}

Matrix6d Midway::covariance(const Matrix6d& a, const Matrix6d& b) const {
  Matrix6d sum =
      share_a_ * (transport_a_ * a * transport_a_.transpose() + mean_a_ * mean_a_.transpose()) +
      share_b_ * (transport_b_ * b * transport_b_.transpose() + mean_b_ * mean_b_.transpose());
  symmetrize(sum);
  return sum;
}

}  // namespace posemix::internal
