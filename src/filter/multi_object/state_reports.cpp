// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <utility>
#include <vector>

#include "multi_object_state.hpp"
#include "posemix/filter/update.hpp"

/// What is reported of a state.
namespace posemix::internal {

namespace {

/// The largest of the errors in common of the detectors that saw the object.
Matrix6d largest_common(const std::vector<LearnedSensor>& detectors) {
  Matrix6d largest = Matrix6d::Zero();
  for (const LearnedSensor& detector : detectors) {
    if (detectors.size() > 1 && detector.detections() == 0) continue;
    const auto common = detector.common_covariance();
    if (common && common->trace() > largest.trace()) largest = *common;
  }
  return largest;
}

}  // namespace

Matrix6d MultiObjectState::unseen_covariance(const TrackedObject& object, const SE3d& pose) {
  const ObjectSensor& sensor = object.sensor();
  Matrix6d local = sensor.symmetries.unobserved_covariance();
  local += largest_common(object.detectors);
  return pose.adjoint_congruence(local);
}

ConcentratedGaussian<SE3d> MultiObjectState::reported_camera() const {
  return ConcentratedGaussian<SE3d>::trusted(joint.pose(kCamera),
                                             joint.covariance(kCamera, kCamera) + world_error);
}

DetectionState MultiObjectState::reported(const TrackedObject& object, std::size_t h) const {
  DetectionState state = object.belief.state(joint, h);
  for (const Eigen::Index row : {kCameraRow, kObjectRow}) {
    for (const Eigen::Index column : {kCameraRow, kObjectRow})
      state.covariance.block<6, 6>(row, column) += world_error;
  }
  state.covariance.block<6, 6>(kObjectRow, kObjectRow) += unseen_covariance(object, state.object);
  return state;
}

ConcentratedGaussian<PoseStackd> MultiObjectState::reported_joint(
    const WorldShift& to_world) const {
  const Eigen::MatrixXd all = joint.covariance();
  std::vector<SE3d> poses;
  std::vector<Eigen::Index> coordinates;
  std::vector<std::size_t> pose_of(joint.size(), 0);
  for (std::size_t i = 0; i < joint.size(); ++i) {
    if (!joint.is_pose(i) || joint.is_extrinsic(i)) continue;
    pose_of[i] = poses.size();
    poses.push_back(joint.pose(i));
    for (Eigen::Index k = 0; k < kPoseDof; ++k) coordinates.push_back(offset(i) + k);
  }
  Eigen::MatrixXd covariance = all(coordinates, coordinates);
  for (std::size_t i = 0; i < joint.size(); ++i) {
    for (std::size_t k = 0; k < joint.size(); ++k) {
      if (joint.is_in_world(i) && joint.is_in_world(k))
        block(covariance, pose_of[i], pose_of[k]) += world_error;
    }
  }
  for (const TrackedObject& object : objects) {
    const auto index = object.belief.pose_index();
    if (!index) continue;
    const std::size_t i = pose_of[*index];
    block(covariance, i, i) += unseen_covariance(object, poses[i]);
  }
  for (std::size_t i = 0; i < joint.size(); ++i) {
    if (!joint.is_in_world(i)) continue;
    poses[pose_of[i]] = to_world(poses[pose_of[i]]);
    to_world.move_rows(rows(covariance, pose_of[i]));
    to_world.move_columns(columns(covariance, pose_of[i]));
  }
  symmetrize(covariance);
  return ConcentratedGaussian<PoseStackd>::trusted(PoseStackd(std::move(poses)),
                                                   std::move(covariance));
}

std::vector<HypothesisMean> MultiObjectState::hypothesis_means(const TrackedObject& object,
                                                               const WorldShift& to_world) const {
  const std::vector<double> probabilities = object.belief.probabilities();
  std::vector<HypothesisMean> list;
  list.reserve(object.belief.size());
  for (std::size_t h = 0; h < object.belief.size(); ++h) {
    list.push_back({.pose = to_world(object.belief.mean(joint, h)),
                    .probability = probabilities[h],
                    .id = object.belief.standing(h).id});
  }
  return list;
}

std::vector<std::optional<LeadingEstimate>> MultiObjectState::leading_estimates(
    const WorldShift& to_world) const {
  const std::vector<PoseMoments> moments = joint.pose_moments();
  std::vector<std::optional<LeadingEstimate>> list;
  for (const TrackedObject& object : objects) {
    const auto index = object.belief.pose_index();
    if (!index) {
      list.emplace_back();
      continue;
    }
    const SE3d& pose = joint.pose(*index);
    const Matrix6d cross = moments[*index].cross_covariance + world_error;
    Eigen::MatrixXd covariance(12, 12);
    covariance << moments[kCamera].covariance + world_error, cross.transpose(), cross,
        moments[*index].covariance + world_error + unseen_covariance(object, pose);
    const auto pair = ConcentratedGaussian<PoseStackd>::trusted(
        PoseStackd({joint.pose(kCamera), pose}), std::move(covariance));
    list.emplace_back(LeadingEstimate{to_world(marginal(pair, 1)), relative_pose(pair, 0, 1)});
  }
  return list;
}

}  // namespace posemix::internal
