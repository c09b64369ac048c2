// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "multi_object_state.hpp"
#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using internal::CameraAlternative;
using internal::ObjectState;
using internal::Pair;
using internal::PairMoments;
using internal::PairUpdate;

/// Offsets nearer to each other than this are one mode.
constexpr double kSameMode = 1e-9;

/// Moments of the camera under all hypotheses but the leading one, and under the object's absence
/// (or its birth), where the camera is as before.
class AlternativeMoments {
 public:
  explicit AlternativeMoments(const Matrix6d& before) : before_(before) {}

  void add_unmoved(double weight) {
    weight_ += weight;
    second_ += weight * before_;
  }
  void add(double weight, const PairMoments& pair) {
    const Vector6d mean = pair.mean.head<6>();
    weight_ += weight;
    mean_ += weight * mean;
    second_ += weight * (pair.covariance.topLeftCorner<6, 6>() + mean * mean.transpose());
  }
  CameraAlternative moments() const {
    if (weight_ <= 0.0) return {0.0, Vector6d::Zero(), before_};
    const Vector6d mean = mean_ / weight_;
    return {weight_, mean, second_ / weight_ - mean * mean.transpose()};
  }

 private:
  Matrix6d before_;
  double weight_ = 0.0;
  Vector6d mean_ = Vector6d::Zero();
  Matrix6d second_ = Matrix6d::Zero();
};

}  // namespace

/// Hypotheses at the detection, one for each mode of the noise, with the likelihood of an object
/// that was not seen before.
std::vector<ObjectHypothesis> MultiObjectFilter::State::births_of(const ObjectState& object,
                                                                  const SE3d& detected) {
  constexpr double kPi = std::numbers::pi;
  const DetectorNoise& noise = object.sensor.noise;
  const Matrix6d camera = joint.covariance(kCamera, kCamera);
  const double log_density =
      object.log_absent - std::log(8.0 * kPi * kPi * noise.clutter().volume_m3);
  std::vector<ObjectHypothesis> births;
  std::vector<const NoiseComponent*> modes;
  for (const NoiseComponent& component : noise.components()) {
    const auto known = std::find_if(modes.begin(), modes.end(), [&](const NoiseComponent* mode) {
      return (mode->offset.inverse() * component.offset).log().norm() < kSameMode;
    });
    if (known != modes.end()) {
      double& weight = births[static_cast<std::size_t>(known - modes.begin())].log_weight;
      weight += std::log1p(component.weight / std::exp(weight - log_density));
      continue;
    }
    modes.push_back(&component);
    const Pair there{joint.pose(kCamera),
                     joint.pose(kCamera) * detected * component.offset.inverse(),
                     internal::Matrix12d::Zero()};
    const Matrix6d spread = internal::innovation(there, detected, component, object.sensor).noise;
    ObjectHypothesis& hypothesis = births.emplace_back();
    hypothesis.pose = there.object;
    hypothesis.covariance = camera + settings.birth_covariance_factor * spread;
    hypothesis.cross_covariance = camera;
    hypothesis.log_weight = log_density + std::log(component.weight);
    hypothesis.score = settings.birth_score;
    hypothesis.id = next_id++;
    hypothesis.detections = 1;
  }
  return births;
}

/// The camera's moments over all hypotheses of the object, and what follows from them for the
/// joint and for every other hypothesis.
void MultiObjectFilter::State::move_camera(ObjectState& object,
                                           const std::vector<PairUpdate>& updates,
                                           double log_evidence,
                                           std::vector<ObjectHypothesis>& births) {
  const Matrix6d before = joint.covariance(kCamera, kCamera);
  const auto share = [&](double log_weight) { return std::exp(log_weight - log_evidence); };
  AlternativeMoments alternative(before);
  alternative.add_unmoved(share(object.log_absent));
  for (const ObjectHypothesis& hypothesis : births)
    alternative.add_unmoved(share(hypothesis.log_weight));
  for (std::size_t h = 0; h < updates.size(); ++h) {
    if (h != object.leading)
      alternative.add(share(object.hypotheses[h].log_weight), updates[h].posterior);
  }
  const Vector6d moved =
      joint.update(*object.index, updates[object.leading].posterior, alternative.moments());
  const Matrix6d after = joint.covariance(kCamera, kCamera);
  for (ObjectState& other : objects) {
    for (std::size_t h = 0; h < other.hypotheses.size(); ++h) {
      ObjectHypothesis& hypothesis = other.hypotheses[h];
      if (other.index && h == other.leading) continue;
      if (&other != &object) {
        internal::follow_camera(hypothesis, Vector6d::Zero(), before, moved, after);
        continue;
      }
      const PairMoments& pair = updates[h].posterior;
      hypothesis.pose = SE3d::exp(pair.mean.tail<6>()) * hypothesis.pose;
      hypothesis.covariance = pair.covariance.bottomRightCorner<6, 6>();
      hypothesis.cross_covariance = pair.covariance.bottomLeftCorner<6, 6>();
      internal::follow_camera(hypothesis, pair.mean.head<6>(),
                              pair.covariance.topLeftCorner<6, 6>(), moved, after);
    }
  }
  for (ObjectHypothesis& hypothesis : births)
    internal::follow_camera(hypothesis, Vector6d::Zero(), before, moved, after);
}

/// What the detection says to every hypothesis.
std::vector<PairUpdate> MultiObjectFilter::State::observe(const ObjectState& object,
                                                          const SE3d& detected) const {
  std::vector<PairUpdate> updates;
  updates.reserve(object.hypotheses.size());
  for (std::size_t h = 0; h < object.hypotheses.size(); ++h) {
    updates.push_back(internal::observe(internal::pair_of(joint, object, h), detected,
                                        object.sensor, settings.camera_gain_noise,
                                        settings.has_odometry));
  }
  return updates;
}

/// Multiplies the weights by their evidence. Returns the logarithm of their sum.
double MultiObjectFilter::State::weigh(ObjectState& object, const std::vector<PairUpdate>& updates,
                                       const std::vector<ObjectHypothesis>& births) const {
  const double log_clutter = object.sensor.noise.log_clutter_density();
  std::vector<double> terms;
  for (std::size_t h = 0; h < updates.size(); ++h) {
    ObjectHypothesis& hypothesis = object.hypotheses[h];
    hypothesis.log_weight += updates[h].log_evidence;
    hypothesis.score = settings.score_memory * hypothesis.score +
                       (std::isfinite(log_clutter) ? updates[h].log_evidence - log_clutter : 0.0);
    ++hypothesis.detections;
    terms.push_back(hypothesis.log_weight);
  }
  for (const ObjectHypothesis& hypothesis : births) terms.push_back(hypothesis.log_weight);
  object.log_absent += log_clutter;
  terms.push_back(object.log_absent);
  return log_sum_exp(terms);
}

/// The noise's scale and dependence, from the leading hypothesis.
void MultiObjectFilter::State::learn(ObjectState& object, const PairUpdate& leader,
                                     ObjectUpdateReport& report) const {
  report.inlier_probability = leader.inlier_probability;
  report.clutter_probability = leader.clutter_probability;
  report.residual = leader.residual.cwiseQuotient(leader.residual_variance.cwiseSqrt());
  learn_scale(object, leader);
  if (report.inlier_probability > 0.5) object.dependence.add(report.residual);
}

/// Births, merging, the cap, and who leads. Returns the number of merges.
std::size_t MultiObjectFilter::State::settle(ObjectState& object,
                                             std::vector<ObjectHypothesis> births) {
  std::move(births.begin(), births.end(), std::back_inserter(object.hypotheses));
  if (object.hypotheses.empty()) return 0;
  if (!object.index) {
    const ObjectHypothesis& first = object.hypotheses.front();
    object.leading = 0;
    object.index = joint.append(first.pose, first.covariance, first.cross_covariance);
  }
  const std::size_t merges = internal::merge_hypotheses(joint, object, merge_bounds);
  internal::normalise(object);
  internal::keep_best(object, settings.max_hypotheses, settings.protected_hypotheses);
  internal::normalise(object);
  internal::choose_leader(joint, object, settings.leader_margin);
  return merges;
}

ObjectUpdateReport MultiObjectFilter::State::update(std::size_t j, const SE3d& detected) {
  ObjectState& object = objects[j];
  begin(object);
  walk(object);
  const std::vector<PairUpdate> updates = observe(object, detected);
  const bool is_explained =
      std::any_of(updates.begin(), updates.end(),
                  [&](const PairUpdate& update) { return update.squared_distance < explained; });
  std::vector<ObjectHypothesis> births;
  if (!is_explained && std::isfinite(object.log_absent)) births = births_of(object, detected);

  ObjectUpdateReport report;
  const bool was_known = object.index.has_value();
  const std::uint64_t led = was_known ? object.hypotheses[object.leading].id : 0;
  report.started = !births.empty();
  report.log_evidence = weigh(object, updates, births);
  if (was_known) {
    learn(object, updates[object.leading], report);
    move_camera(object, updates, report.log_evidence, births);
  }
  report.merges = settle(object, std::move(births));
  report.changed_leader =
      object.index && (!was_known || object.hypotheses[object.leading].id != led);
  return report;
}

}  // namespace posemix
