// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// Densities over several poses of the filter: an object before the camera, and all of them jointly.
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "filter_checks.hpp"
#include "global_hypotheses.hpp"
#include "posemix/density/pose_stack.hpp"
#include "posemix/filter/multi_object_filter.hpp"
#include "posemix/filter/update.hpp"

namespace posemix {

using namespace internal;

namespace {

/// The marginal of the blocks at `order`: poses, then slow errors.
JointState marginal_of(const JointGaussian& joint, const std::vector<std::size_t>& order) {
  std::vector<SE3d> poses;
  JointState state;
  const Eigen::MatrixXd all = joint.covariance();
  state.covariance.resize(offset(order.size()), offset(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (joint.is_pose(order[i])) {
      poses.push_back(joint.pose(order[i]));
    } else {
      state.slow.conservativeResize(state.slow.size() + kPoseDof);
      state.slow.tail<kPoseDof>() = joint.slow(order[i]);
    }
    for (std::size_t k = 0; k < order.size(); ++k)
      block(state.covariance, i, k) = block(all, order[i], order[k]);
  }
  state.poses = PoseStackd(std::move(poses));
  return state;
}

/// In place of every slow error, in the order of the objects, those of all cameras. Those that do
/// not see now are independent of each other given the pose and the slow error that was there.
void add_cameras(const MultiObjectState& filter,
                 std::span<const std::optional<std::size_t>> hypotheses,
                 std::span<const ObservationSource> cameras, JointState& state) {
  const auto poses = static_cast<Eigen::Index>(state.poses.size());
  const Eigen::Index before = state.covariance.rows();
  const Eigen::Index after =
      state.poses.dof() + state.slow.size() * static_cast<Eigen::Index>(cameras.size());
  Eigen::MatrixXd from = Eigen::MatrixXd::Zero(after, before);
  from.topLeftCorner(state.poses.dof(), state.poses.dof()).setIdentity();
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(after, after);
  Eigen::VectorXd slow(after - state.poses.dof());
  auto pose = static_cast<std::size_t>(filter.motion ? 2 : 1);
  std::size_t last = static_cast<std::size_t>(poses);  // the block of the slow error
  std::size_t at = last;
  for (std::size_t j = 0; j < filter.objects.size(); ++j) {
    if (!hypotheses[j]) continue;
    const TrackedObject& object = filter.objects[j];
    if (object.sensor().slow_covariance()) {
      for (const ObservationSource& camera : cameras) {
        const CameraSlowError one = object.belief.slow_error_of(
            filter.joint, *hypotheses[j], camera, cameras.front(), object.sensor());
        block(from, at, pose) = one.on_object;
        block(from, at, kCamera) = -one.on_object;
        block(from, at, last) = one.on_seeing;
        block(noise, at, at) = one.covariance;
        slow.segment<kPoseDof>(offset(at) - state.poses.dof()) = one.mean;
        ++at;
      }
      ++last;
    }
    ++pose;
  }
  state.slow = slow;
  state.covariance = (from * state.covariance * from.transpose() + noise).eval();
  symmetrize(state.covariance);
}

}  // namespace

ConcentratedGaussian<SE3d> MultiObjectFilter::relative(std::size_t object,
                                                       std::size_t hypothesis) const {
  require_object(object, object_count());
  require_hypothesis(hypothesis, object, current().objects[object].belief.size());
  const DetectionState state = current().reported(current().objects[object], hypothesis);
  return ConcentratedGaussian<SE3d>::trusted(
      state.camera_object(), state.camera.inverse().adjoint_congruence(state.difference()));
}

ConcentratedGaussian<SE3d> MultiObjectFilter::predicted_detection(std::size_t object,
                                                                  std::size_t hypothesis,
                                                                  const SE3d& body_camera) const {
  return predicted_detection(object, hypothesis, ObservationSource{.body_camera = body_camera});
}

ConcentratedGaussian<SE3d> MultiObjectFilter::predicted_detection(
    std::size_t object, std::size_t hypothesis, const ObservationSource& source) const {
  require_object(object, object_count());
  require_hypothesis(hypothesis, object, current().objects[object].belief.size());
  if (source.camera) require_camera(*source.camera, extrinsic_count());
  const TrackedObject& tracked = current().objects[object];
  const ObjectSensor& sensor = tracked.sensor();
  const DetectionState state =
      tracked.belief.state_seen_from(current().joint, hypothesis, source, sensor);
  const Matrix6d a = slow_error_map(state, sensor.noise.components().front(), sensor);
  // xi_O - xi_C + A b.
  Eigen::Matrix<double, 6, 18> h;
  h << -Matrix6d::Identity(), Matrix6d::Identity(), a;
  const SE3d seen = SE3d::exp(a * state.slow) * state.object;
  const Matrix6d covariance = h * state.covariance * h.transpose();
  return ConcentratedGaussian<SE3d>::trusted(state.camera.inverse() * seen,
                                             state.camera.inverse().adjoint_congruence(covariance));
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint() const { return current_joint(); }

const ConcentratedGaussian<PoseStackd>& MultiObjectFilter::current_joint() const {
  return hypotheses_of_all().joint();
}

ConcentratedGaussian<PoseStackd> MultiObjectFilter::joint_of(
    std::span<const std::optional<std::size_t>> hypotheses) const {
  JointState state = joint_state(hypotheses);
  const Eigen::Index dof = state.poses.dof();
  Eigen::MatrixXd covariance = state.covariance.topLeftCorner(dof, dof);
  std::size_t index = current().motion ? 2 : 1;
  for (std::size_t j = 0; j < object_count(); ++j) {
    if (!hypotheses[j]) continue;
    block(covariance, index, index) += unseen_covariance(j, state.poses[index]);
    ++index;
  }
  return ConcentratedGaussian<PoseStackd>::trusted(state.poses, std::move(covariance));
}

JointState MultiObjectFilter::joint_state(
    std::span<const std::optional<std::size_t>> hypotheses) const {
  return joint_state(hypotheses, {});
}

JointState MultiObjectFilter::joint_state(std::span<const std::optional<std::size_t>> hypotheses,
                                          std::span<const ObservationSource> cameras) const {
  for (const ObservationSource& one : cameras)
    if (one.camera) require_camera(*one.camera, extrinsic_count());
  if (hypotheses.size() != object_count()) {
    throw InvalidInput(fmt::format("hypotheses of {} objects, but there are {}", hypotheses.size(),
                                   object_count()));
  }
  // The joint Gaussian with the alternatives that were asked for; the poses, then the slow errors.
  JointGaussian all = current().joint;
  std::vector<std::size_t> order{kCamera};
  if (current().motion) order.push_back(*current().motion);
  std::vector<std::size_t> slow;
  for (std::size_t j = 0; j < object_count(); ++j) {
    const auto& belief = current().objects[j].belief;
    const auto h = hypotheses[j];
    if (!h) continue;
    require_hypothesis(*h, j, belief.size());
    const std::size_t index = h == belief.leading() ? belief.pose_index().value()
                                                    : all.append(belief.pose(current().joint, *h));
    order.push_back(index);
    if (all.blocks_of(index) > 1) slow.push_back(index + 1);
  }
  order.insert(order.end(), slow.begin(), slow.end());
  all.add_world_error(current().world_error);
  JointState state = marginal_of(all, order);
  if (!cameras.empty()) add_cameras(current(), hypotheses, cameras, state);
  const WorldShift to_world = hypotheses_of_all().to_world();
  std::vector<SE3d> poses = state.poses.poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!all.is_in_world(order[i])) continue;
    poses[i] = to_world(poses[i]);
    to_world.move_rows(rows(state.covariance, i));
    to_world.move_columns(columns(state.covariance, i));
  }
  symmetrize(state.covariance);
  state.poses = PoseStackd(std::move(poses));
  return state;
}

}  // namespace posemix
