// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <memory>
#include <utility>

#include "global_hypotheses.hpp"

/// The world of the states has its origin near the camera ("Far from the origin" of
/// docs/many-objects.md).
namespace posemix::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// What took the place of a matrix that joint Gaussians share; made by `move` where none has.
template <class Matrix, class Move>
std::shared_ptr<const Matrix> moved(std::vector<MovedBases::Pair<Matrix>>& known,
                                    const std::shared_ptr<const Matrix>& before, const Move& move) {
  const auto same = std::find_if(known.begin(), known.end(),
                                 [&](const auto& pair) { return pair.first == before; });
  if (same != known.end()) return same->second;
  auto after = std::make_shared<Matrix>(*before);
  move(*after);
  return known.emplace_back(before, std::move(after)).second;
}

}  // namespace

void JointGaussian::add_passive_rows(MovedBases& shared) const {
  for (std::size_t i = 0; i < size(); ++i) {
    if (base_ && is_in_world(i) && blocks_[i].row >= 0)
      shared.pose_rows[base_.get()].insert(blocks_[i].row);
  }
}

/// The base and U have the coordinates of passive poses as rows; carriers keep theirs, but for that
/// of shifts of the world.
void JointGaussian::move_world(const WorldShift& shift, MovedBases& shared) {
  for (std::size_t i = 0; i < size(); ++i) {
    if (!is_in_world(i)) continue;
    Block& block = blocks_[i];
    block.pose = shift(block.pose);
    block.noise = shift(block.noise);
    if (block.at < 0) continue;
    shift.move_rows(covariance_.middleRows<6>(block.at));
    shift.move_columns(covariance_.middleCols<6>(block.at));
  }
  if (linearised_at_) linearised_at_ = shift(*linearised_at_);
  const std::set<Index>& rows = shared.pose_rows[base_.get()];
  for (Carrier& carrier : carriers_) {
    if (carrier.columns) {
      carrier.columns = moved(shared.columns, carrier.columns, [&](SixColumns& columns) {
        for (const Index row : rows) shift.move_rows(columns.middleRows<6>(row));
      });
      continue;
    }
    shift.move_rows(covariance_.middleRows<6>(carrier.at));
    shift.move_columns(covariance_.middleCols<6>(carrier.at));
    shift.move_rows(carrier.mean);
  }
  if (base_) {
    base_ = moved(shared.bases, base_, [&](MatrixXd& lower) {
      MatrixXd base = lower.selfadjointView<Eigen::Lower>();
      for (const Index row : rows) {
        shift.move_rows(base.middleRows<6>(row));
        shift.move_columns(base.middleCols<6>(row));
      }
      lower = std::move(base);
    });
  }
  symmetrize(covariance_);
}

void ObjectBelief::move_world(const WorldShift& shift) {
  for (Alternative& alternative : alternatives_) {
    ConditionalPose& pose = alternative.pose;
    pose.pose = shift(pose.pose);
    shift.move_rows(pose.covariance.topRows<6>());
    shift.move_columns(pose.covariance.leftCols<6>());
    symmetrize(pose.covariance);
    shift.move_rows(pose.cross_covariance.topRows<6>());
    shift.move_columns(pose.cross_covariance);
    if (pose.extrinsics.cols() > 0) shift.move_rows(pose.extrinsics.topRows<6>());
  }
}

void MultiObjectState::move_world(const WorldShift& shift, MovedBases& shared) {
  joint.move_world(shift, shared);
  for (TrackedObject& object : objects) object.belief.move_world(shift);
  world_error = shift(world_error);
  symmetrize(world_error);
  if (rig_motion) rig_motion->given.move_world(shift);
}

Eigen::Vector3d GlobalHypotheses::origin_for(const SE3d& camera) const {
  return origin_near(camera.translation(), origin_);
}

Eigen::Vector3d GlobalHypotheses::origin_for_camera() const {
  return origin_for(to_world()(first().joint.pose(kCamera)));
}

void GlobalHypotheses::move_origin_to(const Eigen::Vector3d& origin) {
  if (origin == origin_) return;
  const WorldShift shift(origin_ - origin);
  MovedBases shared;
  for (const Weighted& one : list_) one.state.joint.add_passive_rows(shared);
  for (Weighted& one : list_) one.state.move_world(shift, shared);
  origin_ = origin;
  reset_reports();
}

void GlobalHypotheses::stay_near_the_origin() {
  reset_reports();
  move_origin_to(origin_for_camera());
}

}  // namespace posemix::internal
