// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "object_merge.hpp"

#include <algorithm>
#include <cmath>

#include "posemix/mixture/log_weights.hpp"
#include "put_down.hpp"

namespace posemix::internal {

bool are_near(const SymmetryGroup& symmetries, const MergeBounds& bounds, const SE3d& a, SE3d b) {
  if ((a.translation() - b.translation()).norm() > bounds.translation_m) return false;
  if (!symmetries.is_trivial()) b = symmetries.closest(b, a, Matrix6d::Identity());
  return (a.rotation().inverse() * b.rotation()).log().norm() <= bounds.rotation_rad;
}

bool agree(const Matrix6d& camera, const SymmetryGroup& symmetries, const MergeBounds& bounds,
           const ConditionalPose& a, ConditionalPose& b) {
  const auto seen_from_camera = [&](const ConditionalPose& object) {
    const Matrix6d cross = object.cross_covariance.topRows<6>();
    return Matrix6d(object.covariance.topLeftCorner<6, 6>() + camera - cross - cross.transpose());
  };
  if (!are_near(symmetries, bounds, a.pose, b.pose)) return false;
  if (!symmetries.is_trivial()) b.pose = symmetries.closest(b.pose, a.pose, Matrix6d::Identity());
  const Cholesky6 mean(0.5 * (seen_from_camera(a) + seen_from_camera(b)));
  const Vector6d z = (b.pose * a.pose.inverse()).log();
  return mean.whitened(z).squaredNorm() < bounds.squared_distance;
}

Standing merged(const Standing& a, const Standing& b) {
  const double weights[] = {a.log_weight, b.log_weight};
  Standing result = a.log_weight >= b.log_weight ? a : b;
  result.log_weight = log_sum_exp(weights);
  const double probabilities[] = {a.log_probability, b.log_probability};
  result.log_probability = log_sum_exp(probabilities);
  result.score = std::max(a.score, b.score);
  result.detections = std::max(a.detections, b.detections);
  if (result.shown.empty()) return result;
  result.shown = a.shown;
  mix_into(result.shown, std::exp(a.log_weight - result.log_weight), b.shown,
           std::exp(b.log_weight - result.log_weight));
  for (ModeWeights& shown : result.shown) {
    for (const std::uint64_t id : {a.id, b.id}) shown.redirect(place_of(id), kAnyPlace, true);
  }
  return result;
}

RowsMidway::RowsMidway(const ConditionalPose& a, double log_weight_a, const ConditionalPose& b,
                       double log_weight_b) {
  share_b_ = 1.0 / (1.0 + std::exp(log_weight_a - log_weight_b));
  share_a_ = 1.0 - share_b_;
  Vector12d distance = Vector12d::Zero();
  distance.head<6>() = (b.pose * a.pose.inverse()).log();
  if (a.slow && b.slow) distance.tail<6>() = *b.slow - *a.slow;
  mean_a_ = -share_b_ * distance;
  mean_b_ = share_a_ * distance;
  pose_ = SE3d::exp(-mean_a_.head<6>()) * a.pose;
  transport_a_ = SE3d::left_jacobian_inverse(mean_a_.head<6>());
  transport_b_ = SE3d::left_jacobian_inverse(mean_b_.head<6>());
}

Matrix12d RowsMidway::covariance(const Matrix12d& a, const Matrix12d& b) const {
  const auto transported = [](const Matrix6d& transport, Matrix12d p) {
    p.topRows<6>() = (transport * p.topRows<6>()).eval();
    p.leftCols<6>() = (p.leftCols<6>() * transport.transpose()).eval();
    return p;
  };
  Matrix12d sum = share_a_ * (transported(transport_a_, a) + mean_a_ * mean_a_.transpose()) +
                  share_b_ * (transported(transport_b_, b) + mean_b_ * mean_b_.transpose());
  symmetrize(sum);
  return sum;
}

ConditionalPose RowsMidway::merged(const ConditionalPose& a, const ConditionalPose& b) const {
  ConditionalPose result{pose_, a.slow, covariance(a.covariance, b.covariance),
                         cross_covariance(a.cross_covariance, b.cross_covariance)};
  if (a.extrinsics.cols() > 0) result.extrinsics = cross_covariance(a.extrinsics, b.extrinsics);
  if (result.slow) *result.slow -= mean_a_.tail<6>();
  return result;
}

}  // namespace posemix::internal
