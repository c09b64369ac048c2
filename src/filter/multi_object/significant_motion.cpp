// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "significant_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "base/cholesky6.hpp"

namespace posemix::internal {
namespace {

using Eigen::Index;

/// Part of the motions that tell directions that is kept from one to the next: of the last ten
/// thousand.
constexpr double kKeptDirections = 0.9999;

/// Standard deviations: six in 1e7 steps along a direction are beyond by chance.
constexpr double kSignificant = 5.0;

/// The same between a pose that is given and the mean of those before, which is one or two aside
/// while directions are not known well.
constexpr double kSignificantlyAside = 6.0;

/// Variance that the follower of a body that moves gets with each pose along the other directions,
/// as a part of that of the pose: what it errs by along the way would last else.
constexpr double kWander = 1e-4;

/// Standard deviations of a detection that the pose of the body at which cameras are linearised may
/// be from it. Two detections of a body that stands are farther apart once in 6e4, and what is
/// taken then is the rest.
constexpr double kSlack = 8.0;

/// Square of a motion beside its noise that tells no direction.
constexpr double kLittleMotion = 1e-7;

/// Of a motion that is exact [rad^2, m^2], and of one along other axes than those of a covariance
/// without an inverse, as a part of its variances.
constexpr double kExactMotion = 1e-18;
constexpr double kExactPart = 1e-6;

bool is_beyond(double deviations, double motion, double variance) {
  return motion * motion > deviations * deviations * variance;
}

/// From the axes of a body to those that it has after a step.
SE3d turn_of(const SE3d& step) { return SE3d(step.rotation().inverse(), Eigen::Vector3d::Zero()); }

Matrix6d turned(const Matrix6d& covariance, const SE3d& step) {
  return turn_of(step).adjoint_congruence(covariance);
}

/// The coordinate is independent of the others, with this variance.
void set_variance(Matrix6d& covariance, Index i, double variance) {
  covariance.row(i).setZero();
  covariance.col(i).setZero();
  covariance(i, i) = variance;
}

Matrix6d congruence(const Matrix6d& map, const Matrix6d& covariance) {
  Matrix6d result = map * covariance * map.transpose();
  symmetrize(result);
  return result;
}

/// The covariance, if it has an inverse, or one near it that has.
Matrix6d invertible(Matrix6d covariance) {
  covariance.diagonal().array() = (1.0 + kExactPart) * covariance.diagonal().array() + kExactMotion;
  return covariance;
}

}  // namespace

MotionDirections::Coordinates MotionDirections::beside(const Matrix6d& noise) const {
  const Matrix6d unit = invertible(noise_.isZero(0.0) ? noise : noise_);
  // Where nothing moved directions would be those of rounding.
  const Matrix6d factor = Cholesky6(unit).factor();
  const Vector6d order = Vector6d::LinSpaced(6.0 * kLittleMotion, kLittleMotion);
  const Matrix6d motions = motions_ + factor * order.asDiagonal() * factor.transpose();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> solver(motions, unit);
  const Matrix6d& axes = solver.eigenvectors();
  return {axes.transpose(), unit * axes};
}

void MotionDirections::add(const Vector6d& motion, const Matrix6d& noise) {
  // By the size of its error: that of a poor pose would decide else.
  const double weight = std::exp(-Cholesky6(invertible(noise)).log_det() / 6.0);
  motions_ = kKeptDirections * motions_ + weight * motion * motion.transpose();
  noise_ = kKeptDirections * noise_ + weight * noise;
}

SE3d SignificantMotion::take(const SE3d& step, const Matrix6d& q) {
  motion_ = turn_of(step).adjoint() * motion_ + step.log();
  noise_ = turned(noise_, step) + q;
  const MotionDirections::Coordinates axes = directions_.beside(noise_);
  Vector6d motion = axes.to * motion_;
  Matrix6d noise = congruence(axes.to, noise_);
  Vector6d taken = Vector6d::Zero();
  for (Index i = 0; i < 6; ++i) {
    if (!is_beyond(kSignificant, motion[i], noise(i, i))) continue;
    taken[i] = std::exchange(motion[i], 0.0);
    set_variance(noise, i, 0.0);
  }
  if (taken.isZero(0.0)) return {};
  directions_.add(motion_, noise_);
  motion_ = axes.from * motion;
  noise_ = congruence(axes.from, noise);
  return SE3d::exp(axes.from * taken);
}

const SE3d& SignificantPose::follow(const SE3d& pose, const Matrix6d& covariance) {
  if (!std::exchange(has_pose_, true)) follower_ = last_ = {pose, covariance};
  const Matrix6d error = follower_.covariance + covariance;
  const MotionDirections::Coordinates axes = directions_.beside(error);
  const Matrix6d now = congruence(axes.to, covariance);
  Matrix6d of_follower = congruence(axes.to, follower_.covariance);
  Vector6d taken = axes.to * (follower_.pose.inverse() * pose).log();
  bool is_elsewhere = false;
  for (Index i = 0; i < 6; ++i) {
    const double before = std::max(0.0, of_follower(i, i));
    const double given = std::max(0.0, now(i, i));
    const bool is_all = is_beyond(kSignificantlyAside, taken[i], before + given);
    const double part = is_all || before + given == 0.0 ? 1.0 : before / (before + given);
    taken[i] *= part;
    set_variance(of_follower, i, part * given);
    is_elsewhere = is_elsewhere || is_all;
  }
  if (is_elsewhere) of_follower.diagonal() += kWander * now.diagonal();
  const SE3d step = SE3d::exp(axes.from * taken);
  follower_ = {follower_.pose * step, turned(congruence(axes.from, of_follower), step)};
  if (!is_elsewhere) return follower_.pose;
  // The errors of what is given are independent; that of the follower stays the same.
  const SE3d motion = last_.pose.inverse() * pose;
  directions_.add(motion.log(), turned(last_.covariance, motion) + covariance);
  last_ = {pose, covariance};
  return follower_.pose;
}

SE3d near_body(const SE3d& at, const SE3d& body, const Matrix6d& noise) {
  const Vector6d apart = (body * at.inverse()).log();
  const double deviations = Cholesky6(noise).whitened(apart).norm();
  if (!(deviations > kSlack)) return at;
  return SE3d::exp((1.0 - kSlack / deviations) * apart) * at;
}

bool is_elsewhere(const SE3d& before, const SE3d& body, const Matrix6d& noise) {
  return Cholesky6(noise).whitened((body * before.inverse()).log()).norm() > kSlack;
}

void SignificantPose::move_world(const WorldShift& shift) {
  follower_.pose = shift(follower_.pose);
  last_.pose = shift(last_.pose);
}

}  // namespace posemix::internal
