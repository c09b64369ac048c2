// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/filter/predict.hpp"

#include <utility>

#include <fmt/format.h>

#include "lie/checked_noise.hpp"
#include "posemix/lie/pose_blocks.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {
namespace {

void add_noise(Eigen::MatrixXd& covariance, std::size_t index, const SE3d& pose,
               const Matrix6d& q) {
  block(covariance, index, index) += pose.adjoint_congruence(q);
}

/// Hypotheses may come from anywhere, and so be without a pose.
void check_holds(const Hypothesis& hypothesis, std::size_t index, const char* what) {
  if (index < hypothesis.mean().size()) return;
  throw InvalidInput(fmt::format("a hypothesis of {} poses, expected {} at index {}",
                                 hypothesis.mean().size(), what, index));
}

}  // namespace

Hypothesis predict_with_odometry(Hypothesis hypothesis, const SE3d& motion, const Matrix6d& q) {
  check_pose(motion, "odometry");
  const Matrix6d noise = internal::checked_noise(q, "noise of the odometry");
  check_holds(hypothesis, kCamera, "the camera");
  auto [mean, covariance] = std::move(hypothesis).release();
  mean[kCamera] = mean[kCamera] * motion;
  add_noise(covariance, kCamera, mean[kCamera], noise);
  return Hypothesis::trusted(std::move(mean), std::move(covariance));
}

Hypothesis predict_random_walk(Hypothesis hypothesis, const Matrix6d& q) {
  return predict_with_odometry(std::move(hypothesis), SE3d(), q);
}

Matrix6d constant_velocity_transfer(const SE3d& camera, const SE3d& motion, double periods) {
  const Vector6d velocity = motion.log();
  return camera.adjoint() * (periods * SE3d::left_jacobian(periods * velocity) *
                             SE3d::left_jacobian_inverse(velocity));
}

Hypothesis predict_constant_velocity(Hypothesis hypothesis, double periods, const Matrix6d& q,
                                     const Matrix6d& q_motion) {
  const Matrix6d noise = internal::checked_noise(q, "noise of the pose");
  const Matrix6d motion_noise = internal::checked_noise(q_motion, "noise of the motion");
  kStamp.check(periods, "periods");
  check_holds(hypothesis, kMotion, "the motion of the camera");
  auto [mean, covariance] = std::move(hypothesis).release();
  const Vector6d velocity = mean[kMotion].log();
  const Matrix6d transfer = constant_velocity_transfer(mean[kCamera], mean[kMotion], periods);
  // Covariance of (xi_R + transfer xi_V, rest): first the rows, then the columns.
  rows(covariance, kCamera) += transfer * rows(covariance, kMotion);
  columns(covariance, kCamera) += columns(covariance, kMotion) * transfer.transpose();
  mean[kCamera] = mean[kCamera] * SE3d::exp(periods * velocity);
  add_noise(covariance, kCamera, mean[kCamera], noise);
  add_noise(covariance, kMotion, mean[kMotion], motion_noise);
  symmetrize(covariance);
  return Hypothesis::trusted(std::move(mean), std::move(covariance));
}

}  // namespace posemix
