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

/// W^-1 of eq. (31) as the camera and one alternative alone have it; none without a factor.
std::optional<Matrix6d> world_information(const ConditionalPose& object,
                                          const CameraMoments& camera,
                                          const SymmetryGroup& symmetries) {
  const Eigen::MatrixXd own =
      camera.rig.empty() ? Eigen::MatrixXd(camera.covariance) : camera.rig.covariance;
  const Eigen::Index c = own.rows();
  const Eigen::Index n = object.slow ? 12 : 6;
  Eigen::MatrixXd p(c + n, c + n);
  p.topLeftCorner(c, c) = own;
  p.block(c, 0, n, 6) = object.cross_covariance.topRows(n);
  if (c > 6) p.block(c, 6, n, c - 6) = object.extrinsics.topRows(n);
  p.bottomRightCorner(n, n) = object.covariance.topLeftCorner(n, n);
  const Eigen::LLT<Eigen::MatrixXd> factor(p);  // of the lower triangle
  if (factor.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(c + n, 6);
  shift.topRows<6>().setIdentity();
  shift.middleRows<6>(c) = moved_by_world(object.pose, symmetries);
  return Matrix6d(shift.transpose() * factor.solve(shift));
}

/// W^-1 of an alternative that knows the world so well that D, whose inverse is `inverse`, is not
/// to be taken out of it.
std::optional<Matrix6d> information_beyond(const Matrix6d& inverse, const ConditionalPose& object,
                                           const CameraMoments& camera,
                                           const SymmetryGroup& symmetries) {
  std::optional<Matrix6d> information = world_information(object, camera, symmetries);
  if (!information || Cholesky6(Matrix6d(inverse - *information)).ok()) return std::nullopt;
  return information;
}

}  // namespace

void ObjectBelief::add_world_error(const Matrix6d& shift) {
  for (Alternative& alternative : alternatives_) {
    alternative.pose.covariance.topLeftCorner<6, 6>() += shift;
    alternative.pose.cross_covariance.topRows<6>() += shift;
  }
}

std::vector<Matrix6d> ObjectBelief::world_information_beyond(
    const Matrix6d& inverse, const CameraMoments& camera, const SymmetryGroup& symmetries) const {
  std::vector<Matrix6d> list;
  for (const Alternative& alternative : alternatives_) {
    const auto one = information_beyond(inverse, alternative.pose, camera, symmetries);
    if (one) list.push_back(*one);
  }
  return list;
}

/// Eq. (32): with x = [xi_O; b] = G [xi_C; xi_E] + e the regression G and the covariance of e stay,
/// and [xi_O - xi_C; b] keeps its covariance by what e gets of its own. An alternative that knows
/// the world has N D N^T taken out as the joint Gaussian has.
void ObjectBelief::take_out_world_error(const WorldPart& part, const CameraMoments& camera,
                                        const SymmetryGroup& symmetries) {
  const Matrix6d& d = part.d;
  for (Alternative& alternative : alternatives_) {
    ConditionalPose& pose = alternative.pose;
    if (part.first_inverse && information_beyond(*part.first_inverse, pose, camera, symmetries)) {
      const Matrix6d moved = moved_by_world(pose.pose, symmetries) * d;
      pose.cross_covariance.topRows<6>() -= moved;
      pose.covariance.topLeftCorner<6, 6>() -=
          moved * moved_by_world(pose.pose, symmetries).transpose();
      symmetrize(pose.covariance);
      continue;
    }
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

WorldMoves MultiObjectState::moved_by_world() const {
  WorldMoves moved(joint.size(), Matrix6d::Zero());
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

std::vector<Matrix6d> MultiObjectState::world_information_beyond(const Matrix6d& inverse) const {
  std::vector<Matrix6d> all;
  const CameraMoments camera = joint.camera_moments();
  for (const TrackedObject& object : objects) {
    const auto own =
        object.belief.world_information_beyond(inverse, camera, object.sensor().symmetries);
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

void MultiObjectState::take_out_world_error(const WorldPart& part) {
  const CameraMoments before = joint.camera_moments();
  joint.take_out(part.d, moved_by_world());
  for (TrackedObject& object : objects)
    object.belief.take_out_world_error(part, before, object.sensor().symmetries);
  world_error += part.d;
}

void MultiObjectState::take_in_world_error() {
  if (world_error.isZero(0.0)) return;
  joint.add_world_error(world_error);
  for (TrackedObject& object : objects) object.belief.add_world_error(world_error);
  world_error.setZero();
}

/// D = 0.9 (sum_k W_k^-1 + W_k^-1 (0.01 Omega) W_k^-1)^-1, which leaves every state a part of W_k
/// that is not small beside 0.01 Omega. Where something was known in the world, alternatives that
/// know it better than what leads count, too.
void GlobalHypotheses::take_out_world_error() {
  const MultiObjectState& first = list_.front().state;
  if (first.update_count % std::max(kDetectionsBetween, first.joint.size()) != 0) return;
  Matrix6d sum = Matrix6d::Zero();
  const auto add = [&](const Matrix6d& information) {
    sum += information + kLeftOfWorld * information * first.world_error * information;
  };
  for (const Weighted& one : list_) {
    const std::optional<Matrix6d> information = one.state.world_information();
    if (!information) return;
    add(*information);
  }
  WorldPart part;
  if (first.has_known_objects || first.camera_given_at) {
    part.first_inverse = sum / kTakenOut;
    for (const Weighted& one : list_) {
      for (const Matrix6d& information : one.state.world_information_beyond(*part.first_inverse))
        add(information);
    }
  }
  symmetrize(sum);
  const Cholesky6 factor(sum);
  if (!factor.ok()) return;
  part.d = kTakenOut * factor.solved_rows(Matrix6d(Matrix6d::Identity()));
  symmetrize(part.d);
  for (Weighted& one : list_) one.state.take_out_world_error(part);
}

}  // namespace posemix::internal
