// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <vector>

#include "base/cholesky6.hpp"
#include "global_hypotheses.hpp"

/// The error of the world, a shift of camera and objects of which no detection tells, and which is
/// kept beside them: eq. (31) and (32) of docs/many-objects.md.
namespace posemix::internal {
namespace {

/// After so many detections, or as many as there are blocks, it is taken out anew.
constexpr std::size_t kDetectionsBetween = 20;

/// The part of W that is taken out at once: what is left is positive definite.
constexpr double kTakenOut = 0.9;

/// How a shift of the world moves an object. The angle about an axis of symmetry stays: that of the
/// pose that stands for all equivalent ones is chosen, and not from the world.
Matrix6d moved_by_world(const SE3d& object, const SymmetryGroup& symmetries) {
  if (symmetries.axes().empty()) return Matrix6d::Identity();
  return object.adjoint() * symmetries.observed_projection() * object.inverse().adjoint();
}

}  // namespace

void ObjectBelief::add_world_error(const Matrix6d& shift) {
  for (Alternative& alternative : alternatives_) {
    alternative.pose.covariance.topLeftCorner<6, 6>() += shift;
    alternative.pose.cross_covariance.topRows<6>() += shift;
  }
}

/// Eq. (32): with x = [xi_O; b] = G [xi_C; xi_E] + e the regression G and the covariance of e stay,
/// and [xi_O - xi_C; b] keeps its covariance by what e gets of its own.
void ObjectBelief::take_out_world_error(const Matrix6d& d, const CameraMoments& camera) {
  for (Alternative& alternative : alternatives_) {
    ConditionalPose& pose = alternative.pose;
    const Matrix12x6d g =
        camera.rig.empty()
            ? regression_on_camera(pose.cross_covariance, camera.covariance)
            : Matrix12x6d(regression_on_rig(pose, camera.rig.covariance).leftCols<6>());
    const Matrix12x6d less = g * d;
    pose.cross_covariance -= less;
    pose.covariance.leftCols<6>() -= less;
    pose.covariance.topRows<6>() -= less.transpose();
    pose.covariance.topLeftCorner<6, 6>() += d;
    symmetrize(pose.covariance);
  }
}

std::vector<Matrix6d> MultiObjectState::moved_by_world() const {
  std::vector<Matrix6d> moved(joint.size(), Matrix6d::Zero());
  moved[kCamera].setIdentity();
  for (const TrackedObject& object : objects) {
    if (const auto index = object.belief.pose_index())
      moved[*index] = internal::moved_by_world(joint.pose(*index), object.sensor().symmetries);
  }
  return moved;
}

std::optional<Matrix6d> MultiObjectState::world_information() const {
  const auto seen = std::count_if(objects.begin(), objects.end(), [](const TrackedObject& one) {
    return one.belief.leading().has_value();
  });
  // A camera that is given again and again takes all in every time.
  const bool is_given = camera_given_at && update_count - *camera_given_at < kDetectionsBetween;
  if (seen < 2 || is_given) return std::nullopt;
  return joint.world_information(moved_by_world());
}

void MultiObjectState::take_out_world_error(const Matrix6d& d) {
  const CameraMoments before = joint.camera_moments();
  joint.take_out(d, moved_by_world());
  for (TrackedObject& object : objects) object.belief.take_out_world_error(d, before);
  world_error += d;
}

void MultiObjectState::take_in_world_error() {
  if (world_error.isZero(0.0)) return;
  joint.add_world_error(world_error);
  for (TrackedObject& object : objects) object.belief.add_world_error(world_error);
  world_error.setZero();
}

/// D = 0.9 (sum_k W_k^-1 + W_k^-1 (0.01 Omega) W_k^-1)^-1, which leaves every state a part of W_k
/// that is not small beside 0.01 Omega.
void GlobalHypotheses::take_out_world_error() {
  const MultiObjectState& first = list_.front().state;
  if (first.update_count % std::max(kDetectionsBetween, first.joint.size()) != 0) return;
  Matrix6d sum = Matrix6d::Zero();
  for (const Weighted& one : list_) {
    const std::optional<Matrix6d> information = one.state.world_information();
    if (!information) return;
    sum += *information + kLeftOfWorld * *information * one.state.world_error * *information;
  }
  symmetrize(sum);
  const Cholesky6 factor(sum);
  if (!factor.ok()) return;
  Matrix6d d = kTakenOut * factor.solved_rows(Matrix6d(Matrix6d::Identity()));
  symmetrize(d);
  for (Weighted& one : list_) one.state.take_out_world_error(d);
}

}  // namespace posemix::internal
