// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "multi_object_state.hpp"
#include "posemix/filter/update.hpp"
#include "posemix/mixture/log_weights.hpp"

/// The split of a state by the hypotheses of one object, and its inverse (docs/many-objects.md,
/// "Global hypotheses").
namespace posemix::internal {

std::pair<WeighedObservation, WeighedObservation> parted(const WeighedObservation& observation,
                                                         std::size_t k) {
  WeighedObservation own = observation;
  own.log_clutter = -std::numeric_limits<double>::infinity();
  WeighedObservation others = own;
  own.components = {observation.components[k]};
  others.components.erase(others.components.begin() + static_cast<std::ptrdiff_t>(k));
  return {std::move(own), std::move(others)};
}

double MultiObjectState::tie_loss(std::size_t j, const ObservedDetection& observed,
                                  const Starters& may_start) const {
  const TrackedObject& object = objects[j];
  const auto leading = object.belief.leading();
  // A run of wrong detections at the place of an alternative needs that place in the same state.
  if (object.put_down) return 0.0;
  if (!leading || (object.belief.size() < 2 && !std::isfinite(object.belief.log_absent())))
    return 0.0;
  // A component that starts a hypothesis is of no known one, and leaves the camera as it is.
  const WeighedObservation& observation = observed.observation;
  const Clutter& clutter = object.detectors[observation.source.detector].sensor().noise.clutter();
  double starting = 0.0;
  for (std::size_t k = 0; k < may_start.size(); ++k)
    starting += may_start[k] ? observation.components[k].weight : 0.0;
  Alternatives births;
  if (starting > 0.0) {
    births.push_back({{}, {{}, {}, Matrix12d::Zero(), Matrix12x6d::Zero()}});
    births.front().standing.log_weight =
        object.belief.log_absent() +
        std::log(starting * observation.object_weight * (1.0 - clutter.weight)) -
        std::log(8.0 * std::numbers::pi * std::numbers::pi * clutter.volume_m3);
  }
  ObjectBelief after = object.belief;
  after.multiply_weights(observed.updates, observation.log_absence, 0.0);
  const CameraMoments camera = observed.updates[*leading].camera();
  const CameraAlternative others = after.camera_alternative(
      observed.updates, births, after.log_total(births), joint.camera_moments());
  const bool can_win = object.belief.has_alternative_that_can_win(supported_score());
  return merge_loss(can_win ? std::max(others.weight, 0.5) : others.weight, camera,
                    {others.mean, others.covariance, others.rig});
}

std::optional<std::size_t> MultiObjectState::component_apart(
    std::size_t j, const ObservedDetection& observed) const {
  constexpr double kLeast = 1e-4;   // a component with less cannot move the camera by much
  constexpr double kClutter = 0.1;  // with more the observation says little of the camera
  const std::size_t count = observed.observation.components.size();
  const auto leading = objects[j].belief.leading();
  if (!leading || count < 2 || objects[j].put_down) return std::nullopt;
  const Explanation& explanation = observed.updates[*leading].explanation;
  if (!(explanation.clutter_probability < kClutter)) return std::nullopt;
  std::vector<double> probabilities;
  probabilities.reserve(count);
  for (std::size_t k = 0; k < count; ++k) probabilities.push_back(explanation.probability_of(k));
  const auto most = std::max_element(probabilities.begin(), probabilities.end());
  const auto k = static_cast<std::size_t>(most - probabilities.begin());
  const double rest = 1.0 - explanation.clutter_probability - *most;
  if (!(rest > kLeast)) return std::nullopt;
  const auto [own, others] = parted(observed.observation, k);
  const CameraMoments a = observe(j, own).updates[*leading].camera();
  const CameraMoments b = observe(j, others).updates[*leading].camera();
  const double loss = merge_loss(rest / (rest + *most), a, b);
  return loss > settings.split_loss ? std::optional(k) : std::nullopt;
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
Alternatives given_camera(const MultiObjectState& other, const ObjectBelief& belief,
                          const LogTotals& weight, bool shares_leader, const CameraMoments& before,
                          const CameraMoments& after) {
  Alternatives list;
  const CameraRegression step(before, after);
  for (std::size_t h = 0; h < belief.size(); ++h) {
    Alternative one{belief.standing(h), {{}, {}, Matrix12d::Zero(), Matrix12x6d::Zero()}};
    one.standing.log_weight += weight.weight;
    one.standing.log_probability += weight.probability;
    if (!shares_leader || h != belief.leading()) {
      one.pose = belief.pose(other.joint, h);
      step.carry(one.pose);
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
  const CameraRegression step(before, after);
  for (std::size_t j = 0; j < objects.size(); ++j) {
    ObjectBelief& belief = objects[j].belief;
    const ObjectBelief& from = other.objects[j].belief;
    belief.follow_camera(step);
    belief.mix(
        joint, own,
        {given_camera(other, from, others, shares_leader[j], there, after),
         {from.log_absent() + others.weight, from.log_absence_probability() + others.probability},
         shares_leader[j],
         from.lost_shown()},
        objects[j].sensor().symmetries, merge_bounds, next_id);
    belief.normalise();
    reduce(objects[j]);
  }
}

}  // namespace posemix::internal
