// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <numeric>

#include "global_hypotheses.hpp"

/// Which objects are active, and the base that all global hypotheses share (docs/many-objects.md,
/// "Hundreds of landmarks").
namespace posemix::internal {
namespace {

/// Variances of the error that camera and objects have in common, (20 deg)^2 and (0.6 m)^2, beyond
/// which nothing becomes passive: what objects have apart from it would be lost in it. The error of
/// the world is kept beside the joint Gaussian, but for a hundredth, and between a prior or a
/// camera that is given and what is learned of the world by it.
constexpr double kUncertainRotation = 0.122;  // [rad^2]
constexpr double kUncertainPosition = 0.36;   // [m^2]

/// Whether the camera has so large an error in common with every object that was seen, at its
/// place. That of a camera that has lost its way is no error of those that it saw before.
bool is_world_uncertain(const MultiObjectState& state) {
  const WorldShift to_camera(-state.joint.pose(kCamera).translation());
  return std::all_of(state.objects.begin(), state.objects.end(), [&](const TrackedObject& object) {
    const auto index = object.belief.pose_index();
    if (!index || object.last_update == 0) return true;
    const Matrix6d common = to_camera(state.joint.covariance(*index, kCamera));
    return common.diagonal().head<3>().maxCoeff() > kUncertainRotation ||
           common.diagonal().tail<3>().maxCoeff() > kUncertainPosition;
  });
}

/// Whether an active object is known so much worse than a detection of it tells that passive blocks
/// would lose its detections: they follow the active ones by products of four such standard
/// deviations, of which what a detection tells is to be left.
bool is_place_uncertain(const MultiObjectState& state, const TrackedObject& object) {
  constexpr double kMostRatio = 300.0;
  const auto index = object.belief.pose_index();
  if (!index || !state.joint.is_active(*index)) return false;
  const SE3d& pose = state.joint.pose(*index);
  const NoiseAtPose noise = noise_at(object.sensor().noise.components().front(),
                                     state.joint.pose(kCamera).inverse() * pose);
  const Matrix6d at_place = WorldShift(-pose.translation())(state.joint.covariance(*index, *index));
  return at_place.diagonal().tail<3>().maxCoeff() >
         kMostRatio * kMostRatio * noise.covariance.diagonal().tail<3>().minCoeff();
}

/// Whether the same hypothesis of an object leads, or none, in both.
bool led_alike(const ObjectBelief& a, const ObjectBelief& b) {
  if (!a.leading() || !b.leading()) return a.leading().has_value() == b.leading().has_value();
  return a.standing(*a.leading()).id == b.standing(*b.leading()).id;
}

}  // namespace

std::vector<bool> GlobalHypotheses::objects_kept(std::size_t j) const {
  const MultiObjectState& first = list_.front().state;
  const ActiveLimits& limits = first.limits;
  if (std::all_of(list_.begin(), list_.end(),
                  [&](const Weighted& one) {
                    const JointGaussian& joint = one.state.joint;
                    return joint.active() <=
                           (joint.active() == joint.size() ? limits.dense : limits.most);
                  }) ||
      is_world_uncertain(first))
    return {};
  std::vector<std::size_t> order(first.objects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return first.objects[a].last_update > first.objects[b].last_update;
  });
  std::vector<bool> kept(order.size(), false);
  std::size_t blocks = 0;
  std::size_t dropped = 0;
  for (const std::size_t i : order) {
    const auto index = first.objects[i].belief.pose_index();
    const bool is_led_alike = std::all_of(list_.begin(), list_.end(), [&](const Weighted& one) {
      return led_alike(first.objects[i].belief, one.state.objects[i].belief);
    });
    const std::size_t own = index ? first.joint.blocks_of(*index) : 0;
    kept[i] = !is_led_alike || i == j || (blocks + own <= limits.kept && own > 0) ||
              is_place_uncertain(first, first.objects[i]);
    if (kept[i]) {
      blocks += own;
    } else if (index && first.joint.is_active(*index)) {
      dropped += own;
    }
  }
  // A base for few is not worth it, and would be made anew with every detection.
  return dropped < limits.kept ? std::vector<bool>() : kept;
}

void GlobalHypotheses::rebase(const std::vector<bool>& kept) {
  MultiObjectState& first = list_.front().state;
  std::vector<bool> keeps(first.joint.size(), false);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto index = first.objects[i].belief.pose_index();
    if (!index) continue;
    for (std::size_t k = 0; k < first.joint.blocks_of(*index); ++k) keeps[*index + k] = kept[i];
  }
  first.joint.rebase(keeps);
  for (std::size_t k = 1; k < list_.size(); ++k) {
    MultiObjectState& other = list_[k].state;
    BlockPairs same{{kCamera, kCamera}};
    for (std::size_t i = 0; i < other.joint.extrinsics(); ++i)
      same.emplace_back(JointGaussian::extrinsic_block(i), JointGaussian::extrinsic_block(i));
    if (other.motion) same.emplace_back(*other.motion, first.motion.value());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const ObjectBelief& belief = other.objects[i].belief;
      const auto index = belief.pose_index();
      if (!index || !led_alike(belief, first.objects[i].belief)) continue;
      for (std::size_t b = 0; b < other.joint.blocks_of(*index); ++b)
        same.emplace_back(*index + b, *first.objects[i].belief.pose_index() + b);
    }
    other.joint.rebase_like(first.joint, same);
  }
}

void GlobalHypotheses::activate(std::size_t j) {
  const std::vector<bool> kept = objects_kept(j);
  if (!kept.empty()) rebase(kept);
  for (Weighted& one : list_) {
    if (const auto index = one.state.objects[j].belief.pose_index())
      one.state.joint.activate(*index);
  }
}

}  // namespace posemix::internal
