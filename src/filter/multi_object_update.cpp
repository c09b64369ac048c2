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
std::vector<ObjectHypothesis> MultiObjectFilter::State::newborn(const ObjectState& object,
                                                                const SE3d& detected) {
  constexpr double kPi = std::numbers::pi;
  const DetectorNoise& noise = object.sensor.noise;
  const Matrix6d camera = backbone.covariance(kCamera, kCamera);
  const double log_density = object.log_absent - std::log(8.0 * kPi * kPi * noise.null().volume_m3);
  std::vector<ObjectHypothesis> born;
  std::vector<const NoiseComponent*> modes;
  for (const NoiseComponent& component : noise.components()) {
    const auto known = std::find_if(modes.begin(), modes.end(), [&](const NoiseComponent* mode) {
      return (mode->offset.inverse() * component.offset).log().norm() < kSameMode;
    });
    if (known != modes.end()) {
      double& weight = born[static_cast<std::size_t>(known - modes.begin())].log_weight;
      weight += std::log1p(component.weight / std::exp(weight - log_density));
      continue;
    }
    modes.push_back(&component);
    const Pair there{backbone.pose(kCamera),
                     backbone.pose(kCamera) * detected * component.offset.inverse(),
                     internal::Matrix12d::Zero()};
    const Matrix6d spread = internal::innovation(there, detected, component, object.sensor).noise;
    ObjectHypothesis& hypothesis = born.emplace_back();
    hypothesis.pose = there.object;
    hypothesis.covariance = camera + settings.birth_covariance_factor * spread;
    hypothesis.with_camera = camera;
    hypothesis.log_weight = log_density + std::log(component.weight);
    hypothesis.score = settings.birth_score;
    hypothesis.id = next_id++;
    hypothesis.detections = 1;
  }
  return born;
}

/// The camera's moments over all hypotheses of the object, and what follows from them for the
/// backbone and for every other hypothesis.
void MultiObjectFilter::State::move_camera(ObjectState& object,
                                           const std::vector<PairUpdate>& updates,
                                           double log_evidence,
                                           std::vector<ObjectHypothesis>& born) {
  const Matrix6d before = backbone.covariance(kCamera, kCamera);
  const auto share = [&](double log_weight) { return std::exp(log_weight - log_evidence); };
  AlternativeMoments alternative(before);
  alternative.add_unmoved(share(object.log_absent));
  for (const ObjectHypothesis& hypothesis : born)
    alternative.add_unmoved(share(hypothesis.log_weight));
  for (std::size_t h = 0; h < updates.size(); ++h) {
    if (h != object.leading)
      alternative.add(share(object.hypotheses[h].log_weight), updates[h].posterior);
  }
  const Vector6d moved =
      backbone.update(*object.index, updates[object.leading].posterior, alternative.moments());
  const Matrix6d after = backbone.covariance(kCamera, kCamera);
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
      hypothesis.with_camera = pair.covariance.bottomLeftCorner<6, 6>();
      internal::follow_camera(hypothesis, pair.mean.head<6>(),
                              pair.covariance.topLeftCorner<6, 6>(), moved, after);
    }
  }
  for (ObjectHypothesis& hypothesis : born)
    internal::follow_camera(hypothesis, Vector6d::Zero(), before, moved, after);
}

/// What the detection says to every hypothesis.
std::vector<PairUpdate> MultiObjectFilter::State::observe(const ObjectState& object,
                                                          const SE3d& detected) const {
  std::vector<PairUpdate> updates;
  updates.reserve(object.hypotheses.size());
  for (std::size_t h = 0; h < object.hypotheses.size(); ++h) {
    updates.push_back(internal::observe(internal::pair_of(backbone, object, h), detected,
                                        object.sensor, settings.camera_gain_noise,
                                        settings.has_odometry));
  }
  return updates;
}

/// Multiplies the weights by their evidence. Returns the logarithm of their sum.
double MultiObjectFilter::State::weigh(ObjectState& object, const std::vector<PairUpdate>& updates,
                                       const std::vector<ObjectHypothesis>& born) const {
  const double log_null = object.sensor.noise.log_null_density();
  std::vector<double> terms;
  for (std::size_t h = 0; h < updates.size(); ++h) {
    ObjectHypothesis& hypothesis = object.hypotheses[h];
    hypothesis.log_weight += updates[h].log_evidence;
    hypothesis.score = settings.score_memory * hypothesis.score +
                       (std::isfinite(log_null) ? updates[h].log_evidence - log_null : 0.0);
    ++hypothesis.detections;
    terms.push_back(hypothesis.log_weight);
  }
  for (const ObjectHypothesis& hypothesis : born) terms.push_back(hypothesis.log_weight);
  object.log_absent += log_null;
  terms.push_back(object.log_absent);
  return log_sum_exp(terms);
}

/// The noise's scale and dependence, from the leading hypothesis.
void MultiObjectFilter::State::learn(ObjectState& object, const PairUpdate& leader,
                                     ObjectUpdateReport& report) const {
  report.inlier_share = leader.inlier_share;
  report.null_share = leader.null_share;
  report.residual = leader.residual.cwiseQuotient(leader.residual_variance.cwiseSqrt());
  learn_scale(object, leader);
  if (report.inlier_share > 0.5) object.dependence.add(report.residual);
}

/// Births, merging, the cap, and who leads. Returns the number of merges.
std::size_t MultiObjectFilter::State::settle(ObjectState& object,
                                             std::vector<ObjectHypothesis> born) {
  std::move(born.begin(), born.end(), std::back_inserter(object.hypotheses));
  if (object.hypotheses.empty()) return 0;
  if (!object.index) {
    const ObjectHypothesis& first = object.hypotheses.front();
    object.leading = 0;
    object.index = backbone.append(first.pose, first.covariance, first.with_camera);
  }
  const std::size_t merges = internal::merge_hypotheses(backbone, object, merge_bounds);
  internal::normalise(object);
  internal::keep_best(object, settings.max_hypotheses, settings.protected_hypotheses);
  internal::normalise(object);
  internal::choose_leader(backbone, object, settings.leader_margin);
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
  std::vector<ObjectHypothesis> born;
  if (!is_explained && std::isfinite(object.log_absent)) born = newborn(object, detected);

  ObjectUpdateReport report;
  const bool was_known = object.index.has_value();
  const std::uint64_t led = was_known ? object.hypotheses[object.leading].id : 0;
  report.started = !born.empty();
  report.log_evidence = weigh(object, updates, born);
  if (was_known) {
    learn(object, updates[object.leading], report);
    move_camera(object, updates, report.log_evidence, born);
  }
  report.merges = settle(object, std::move(born));
  report.changed_leader =
      object.index && (!was_known || object.hypotheses[object.leading].id != led);
  return report;
}

}  // namespace posemix
