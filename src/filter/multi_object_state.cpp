// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "multi_object_state.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <utility>

#include "posemix/mixture/log_weights.hpp"

namespace posemix {
namespace {

using internal::ObjectState;
using internal::Pair;
using internal::PairUpdate;

/// Detections closer in time count as that far apart.
constexpr double kLeastS = 1e-3;

double squared_distance_at(double probability, const char* name) {
  if (!(probability > 0.0 && probability < 1.0)) {
    throw InvalidInput(fmt::format("{} is {}, expected a number in (0, 1)", name, probability));
  }
  return boost::math::quantile(boost::math::chi_squared(6.0), probability);
}

void check_settings(const MultiObjectSettings& s) {
  require(s.max_hypotheses > 0, "max_hypotheses is 0, expected at least 1");
  require(s.birth_covariance_factor > 0.0, "birth_covariance_factor must be positive");
  require(s.score_memory >= 0.0 && s.score_memory <= 1.0, "score_memory must lie in [0, 1]");
  require(s.leader_margin >= 0.0, "leader_margin must not be negative");
  require(s.camera_gain_noise >= 1.0, "camera_gain_noise must be at least 1");
  require(s.odometry_camera_fraction >= 0.0 && s.odometry_camera_fraction <= 1.0,
          "odometry_camera_fraction must lie in [0, 1]");
  require(s.noise_scale_detections > 0.0, "noise_scale_detections must be positive");
  require(s.least_noise_scale > 0.0 && s.least_noise_scale <= 1.0,
          "least_noise_scale must lie in (0, 1]");
  require(s.correlation_s >= 0.0, "correlation_s must not be negative");
  require(s.correlation_detections >= 0.0, "correlation_detections must not be negative");
  require(s.bias_variance_fraction >= 0.0 && s.bias_variance_fraction < 1.0,
          "bias_variance_fraction must lie in [0, 1)");
  require(s.mode_correlation_factor > 0.0, "mode_correlation_factor must be positive");
}

}  // namespace

MultiObjectFilter::State::State(const ConcentratedGaussian<SE3d>& camera,
                                std::vector<ObjectSensor> sensors, const MultiObjectSettings& given)
    : settings(given),
      explained(squared_distance_at(given.explained_probability, "explained_probability")),
      merge_bounds{given.merge_rotation_rad, given.merge_translation_m,
                   squared_distance_at(given.merge_probability, "merge_probability")},
      joint(camera) {
  check_settings(settings);
  for (ObjectSensor& sensor : sensors) objects.push_back({.sensor = std::move(sensor)});
}

double MultiObjectFilter::State::correlation_length() const {
  double sum = 0.0;
  double weight = 0.0;
  for (const ObjectState& object : objects) {
    if (object.detections == 0) continue;
    const double interval = object.detections > 1 ? (object.last_s - object.first_s) /
                                                        static_cast<double>(object.detections - 1)
                                                  : frame_s;
    const double prior = object.sensor.noise.dependence().dependent_frames.value_or(
        std::max(1.0, settings.correlation_s / std::max(interval, kLeastS)));
    const double share = 1.0 + object.seen;
    sum += share * object.dependence.estimate(prior, settings.correlation_detections);
    weight += share;
  }
  return weight > 0.0 ? sum / weight : 1.0;
}

std::vector<double> MultiObjectFilter::State::probabilities(const ObjectState& object) const {
  const double dependent = std::max(1.0, settings.mode_correlation_factor * correlation_length());
  std::vector<double> terms;
  for (const ObjectHypothesis& hypothesis : object.hypotheses)
    terms.push_back(hypothesis.log_weight / dependent);
  terms.push_back(object.log_absent / dependent);
  const double total = log_sum_exp(terms);
  terms.pop_back();
  for (double& term : terms) term = std::exp(term - total);
  return terms;
}

Matrix6d MultiObjectFilter::State::bias_covariance(const ObjectState& object, const SE3d& camera,
                                                   const SE3d& pose) const {
  const Pair there{camera, pose, internal::Matrix12d::Zero()};
  NoiseComponent component = object.sensor.noise.components().front();
  if (const auto& bias = object.sensor.noise.dependence().bias) {
    component.covariance = *bias;
    return internal::component_noise(there, component, {object.sensor.noise});
  }
  return settings.bias_variance_fraction *
         internal::component_noise(there, component, object.sensor);
}

Pair MultiObjectFilter::State::inflated_pair(const ObjectState& object, std::size_t h) const {
  Pair pair = internal::pair_of(joint, object, h);
  pair.covariance *= factor();
  pair.covariance.bottomRightCorner<6, 6>() += bias_covariance(object, pair.object);
  return pair;
}

/// Counts the detection. At the first of all the filter's covariances become those of detections
/// that count as independent.
void MultiObjectFilter::State::begin(ObjectState& object) {
  const double before = factor();
  if (object.detections++ == 0) object.first_s = now_s;
  object.last_s = now_s;
  const bool first = std::all_of(objects.begin(), objects.end(), [&](const ObjectState& other) {
    return &other == &object ? other.detections == 1 : other.detections == 0;
  });
  if (first) joint.covariance() *= before / factor();
}

/// When the last object is forgotten the filter's covariances become those of the true error again,
/// see begin().
void MultiObjectFilter::State::forget(std::size_t j) {
  const double before = factor();
  ObjectState& object = objects[j];
  if (object.index) {
    const std::size_t erased = *object.index;
    joint.erase(erased);
    for (ObjectState& other : objects) {
      if (other.index && *other.index > erased) --*other.index;
    }
    if (motion && *motion > erased) --*motion;
  }
  ObjectSensor sensor = std::move(object.sensor);
  sensor.noise_scale = object.given_noise_scale;
  object = {.sensor = std::move(sensor)};
  if (std::all_of(objects.begin(), objects.end(),
                  [](const ObjectState& other) { return other.detections == 0; })) {
    joint.covariance() *= before / factor();
  }
}

/// The object's covariance grows by the map's drift since its last detection, and by what no
/// detection can tell: about an axis of symmetry nothing is kept, because what was learned about
/// one estimate of the axis is not about the next.
void MultiObjectFilter::State::walk(ObjectState& object) {
  const Matrix6d grown = drift - object.drift + object.sensor.symmetries.unobserved_covariance();
  object.drift = drift;
  for (ObjectHypothesis& hypothesis : object.hypotheses)
    hypothesis.covariance += hypothesis.pose.adjoint_congruence(grown);
  if (object.index) {
    const std::size_t i = *object.index;
    internal::block(joint.covariance(), i, i) += joint.pose(i).adjoint_congruence(grown);
  }
}

/// The scale of the noise from the innovations of the leading hypothesis: rotation, translation
/// across the ray and along it, each the posterior mean of a variance with `noise_scale_detections`
/// imagined ones of scale one.
void MultiObjectFilter::State::learn_scale(ObjectState& object, const PairUpdate& update) const {
  if (!std::isfinite(settings.noise_scale_detections)) return;
  const Vector6d ratio = update.residual.cwiseAbs2().cwiseQuotient(update.residual_variance);
  const Vector6d now = object.sensor.noise_scale.cwiseAbs2();
  constexpr std::array<std::array<int, 2>, 3> kGroups{{{0, 3}, {3, 2}, {5, 1}}};
  object.seen += update.inlier_probability;
  const double rate = 1.0 / (settings.noise_scale_detections + object.seen);
  for (const auto& [first, count] : kGroups) {
    const double change =
        ratio.segment(first, count).mean() / (1.0 - settings.bias_variance_fraction) - 1.0;
    const double variance = now[first] * (1.0 + update.inlier_probability * rate * change);
    object.sensor.noise_scale.segment(first, count)
        .setConstant(std::sqrt(
            std::clamp(variance, settings.least_noise_scale * settings.least_noise_scale, 1.0)));
  }
}

}  // namespace posemix
