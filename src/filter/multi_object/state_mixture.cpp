// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <cmath>
#include <numbers>

#include "multi_object_state.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

/// The split of a state by the hypotheses of one object, and its inverse (docs/many-objects.md,
/// "Global hypotheses").
namespace posemix::internal {

double MultiObjectState::tie_loss(std::size_t j, const ObservedDetection& observed,
                                  const Starters& may_start) const {
  const TrackedObject& object = objects[j];
  const auto leading = object.belief.leading();
  if (!leading || (object.belief.size() < 2 && !std::isfinite(object.belief.log_absent())))
    return 0.0;
  // A component that starts a hypothesis is of no known one, and leaves the camera as it is.
  const WeighedObservation& observation = observed.observation;
  const Clutter& clutter = object.detectors[observation.source.detector].sensor().noise.clutter();
  double starting = 0.0;
  for (std::size_t k = 0; k < may_start.size(); ++k)
    starting += may_start[k] ? observation.components[k].weight : 0.0;
  std::vector<Alternative> births;
  if (starting > 0.0) {
    births.push_back({{}, {{}, {}, Matrix12d::Zero(), Matrix12x6d::Zero()}});
    births.front().standing.log_weight =
        object.belief.log_absent() +
        std::log(starting * observation.object_weight * (1.0 - clutter.weight)) -
        std::log(8.0 * std::numbers::pi * std::numbers::pi * clutter.volume_m3);
  }
  ObjectBelief after = object.belief;
  after.multiply_weights(observed.updates, observation.log_clutter, 0.0);
  const CameraMoments camera = observed.updates[*leading].camera();
  const CameraAlternative others = after.camera_alternative(
      observed.updates, births, after.log_total(births), joint.camera_moments());
  const bool can_win = object.belief.has_alternative_that_can_win(supported_score());
  return merge_loss(can_win ? std::max(others.weight, 0.5) : others.weight, camera,
                    {others.mean, others.covariance, others.rig});
}

MultiObjectState MultiObjectState::split(std::size_t j, LogTotals& own, LogTotals& others) {
  MultiObjectState rest = *this;
  objects[j].belief.keep_leader();
  own = objects[j].belief.normalise();
  ObjectBelief& belief = rest.objects[j].belief;
  if (const auto erased = belief.drop_leader(rest.joint)) rest.erase(*erased);
  others = belief.normalise();
  return rest;
}

namespace {

/// Hypotheses of an object of another state, as they are given a camera that changed from `before`
/// to `after`, with their weights times those of the state. Of the one that leads in both only the
/// weight is needed.
std::vector<Alternative> given_camera(const MultiObjectState& other, const ObjectBelief& belief,
                                      const LogTotals& weight, bool shares_leader,
                                      const CameraMoments& before, const CameraMoments& after) {
  std::vector<Alternative> list;
  const Eigen::LLT<Matrix6d> factor(before.covariance);
  for (std::size_t h = 0; h < belief.size(); ++h) {
    Alternative one{belief.standing(h), {{}, {}, Matrix12d::Zero(), Matrix12x6d::Zero()}};
    one.standing.log_weight += weight.weight;
    one.standing.log_probability += weight.probability;
    if (!shares_leader || h != belief.leading()) {
      one.pose = belief.pose(other.joint, h);
      follow_camera(one.pose, factor, before, after);
    }
    list.push_back(one);
  }
  return list;
}

/// Whether the same hypothesis leads in both.
bool same_leader(const ObjectBelief& a, const ObjectBelief& b) {
  return a.leading() && b.leading() && a.standing(*a.leading()).id == b.standing(*b.leading()).id;
}

}  // namespace

void MultiObjectState::mix(const MultiObjectState& other, const LogTotals& own,
                           const LogTotals& others) {
  BlockPairs shared{{kCamera, kCamera}};
  for (std::size_t i = 0; i < joint.extrinsics(); ++i)
    shared.emplace_back(JointGaussian::extrinsic_block(i), JointGaussian::extrinsic_block(i));
  if (motion) shared.emplace_back(*motion, other.motion.value());
  std::vector<bool> shares_leader;
  for (std::size_t j = 0; j < objects.size(); ++j) {
    const ObjectBelief& a = objects[j].belief;
    const ObjectBelief& b = other.objects[j].belief;
    shares_leader.push_back(same_leader(a, b));
    if (!shares_leader.back()) continue;
    for (std::size_t k = 0; k < joint.blocks_of(*a.pose_index()); ++k)
      shared.emplace_back(*a.pose_index() + k, *b.pose_index() + k);
  }
  next_id = std::max(next_id, other.next_id);
  const CameraMoments before = joint.camera_moments();
  const CameraMoments there = other.joint.camera_moments(joint);
  const Eigen::VectorXd mean = joint.mix(std::exp(others.weight), other.joint, shared);
  CameraMoments after = joint.camera_moments();
  after.mean = mean.head<6>();
  if (!after.rig.empty()) after.rig.mean = mean;
  for (std::size_t j = 0; j < objects.size(); ++j) {
    ObjectBelief& belief = objects[j].belief;
    const ObjectBelief& from = other.objects[j].belief;
    belief.follow_camera(before, after);
    belief.mix(
        joint, own,
        {given_camera(other, from, others, shares_leader[j], there, after),
         {from.log_absent() + others.weight, from.log_absence_probability() + others.probability},
         shares_leader[j]},
        objects[j].sensor().symmetries, merge_bounds, next_id);
    belief.normalise();
    reduce(objects[j]);
  }
}

}  // namespace posemix::internal
