// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "multi_object_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "posemix/base/statistics.hpp"
#include "posemix/filter/multi_object_ranges.hpp"
#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

/// Offsets nearer to each other than this are one mode.
constexpr double kSameMode = 1e-9;

void check_settings(const MultiObjectSettings& s) {
  require(s.max_hypotheses > 0, "max_hypotheses is 0, expected at least 1");
  for (const auto& [name, field, range] : kMultiObjectNumbers)
    range.check(s.*field, std::string(name));
}

/// A mode of a detector's noise: the components with the same offset.
struct NoiseMode {
  const NoiseComponent* first;
  double log_weight;  ///< log of the summed weights
};

/// The modes of the noise, every weight times exp(log_factor).
std::vector<NoiseMode> modes_of(const DetectorNoise& noise, double log_factor) {
  std::vector<NoiseMode> modes;
  for (const NoiseComponent& component : noise.components()) {
    const auto mode = std::find_if(modes.begin(), modes.end(), [&](const NoiseMode& other) {
      return (other.first->offset.inverse() * component.offset).log().norm() < kSameMode;
    });
    if (mode == modes.end()) {
      modes.push_back({&component, log_factor + std::log(component.weight)});
    } else {
      // log(exp(a) + w exp(d)) = a + log(1 + w / exp(a - d)).
      mode->log_weight += std::log1p(component.weight / std::exp(mode->log_weight - log_factor));
    }
  }
  return modes;
}

void describe(const PairUpdate& leader, ObjectUpdateReport& report) {
  report.inlier_probability = leader.inlier_probability;
  report.clutter_probability = leader.clutter_probability;
  report.residual = leader.white_residual();
}

}  // namespace

MultiObjectState::MultiObjectState(const ConcentratedGaussian<SE3d>& camera,
                                   std::vector<ObjectSensor> sensors,
                                   const MultiObjectSettings& given)
    : settings(given),
      explained(chi_square_quantile(given.explained_probability, 6, "explained_probability")),
      merge_bounds{given.merge_rotation_rad, given.merge_translation_m,
                   chi_square_quantile(given.merge_probability, 6, "merge_probability")},
      joint(camera) {
  check_settings(settings);
  for (ObjectSensor& sensor : sensors) objects.push_back({LearnedSensor(std::move(sensor))});
}

double MultiObjectState::correlation_length() const {
  double sum = 0.0;
  double weight = 0.0;
  for (const auto& [detector, belief, drift_before] : objects) {
    if (detector.detections() == 0) continue;
    const double share = 1.0 + detector.inliers();
    sum += share * detector.correlation_length(settings, frame_s);
    weight += share;
  }
  return weight > 0.0 ? sum / weight : 1.0;
}

std::vector<double> MultiObjectState::probabilities(const TrackedObject& object) const {
  return object.belief.probabilities(
      std::max(1.0, settings.mode_correlation_factor * correlation_length()));
}

Pair MultiObjectState::inflated_pair(const TrackedObject& object, std::size_t h) const {
  Pair pair = object.belief.pair(joint, h);
  pair.covariance *= covariance_factor();
  pair.covariance.bottomRightCorner<6, 6>() +=
      object.detector.bias_covariance(settings, joint.pose(kCamera), pair.object);
  return pair;
}

std::uint64_t MultiObjectState::detections() const {
  std::uint64_t sum = 0;
  for (const TrackedObject& object : objects) sum += object.detector.detections();
  return sum;
}

void MultiObjectState::advance(double dt) {
  now_s += dt;
  frame_s = dt;
}

void MultiObjectState::forget(std::size_t j) {
  const double factor = covariance_factor();
  TrackedObject& object = objects[j];
  if (const auto erased = object.belief.pose_index()) {
    joint.erase(*erased);
    for (TrackedObject& other : objects) other.belief.move_pose_index_up(*erased);
    if (motion && *motion > *erased) --*motion;
  }
  object.detector.reset();
  object = {std::move(object.detector)};
  // Without detections the correlation length is one again. The reported covariance stays.
  if (detections() == 0) joint.covariance() *= factor / covariance_factor();
}

/// Hypotheses at a detection that no hypothesis explains, one for each mode of the noise. Their
/// weight is that of absence times the mode's weight and the density of clutter ("Births"); their
/// covariance is the camera's plus a multiple of the noise's.
std::vector<Alternative> MultiObjectState::births_of(const TrackedObject& object,
                                                     const SE3d& detected,
                                                     const std::vector<PairUpdate>& updates) {
  constexpr double kPi = std::numbers::pi;
  const bool is_explained =
      std::any_of(updates.begin(), updates.end(),
                  [&](const PairUpdate& update) { return update.squared_distance < explained; });
  if (is_explained || !std::isfinite(object.belief.log_absent())) return {};
  const ObjectSensor& sensor = object.detector.sensor();
  const SE3d& camera = joint.pose(kCamera);
  const Matrix6d camera_covariance = joint.covariance(kCamera, kCamera);
  const double log_density =
      object.belief.log_absent() - std::log(8.0 * kPi * kPi * sensor.noise.clutter().volume_m3);
  std::vector<Alternative> births;
  for (const NoiseMode& mode : modes_of(sensor.noise, log_density)) {
    const Pair there{camera, camera * detected * mode.first->offset.inverse(), Matrix12d::Zero()};
    const Matrix6d noise = innovation(there, detected, *mode.first, sensor).noise;
    births.push_back({{.log_weight = mode.log_weight,
                       .score = settings.birth_score,
                       .id = next_id++,
                       .detections = 1},
                      {.pose = there.object,
                       .covariance = camera_covariance + settings.birth_covariance_factor * noise,
                       .cross_covariance = camera_covariance}});
  }
  return births;
}

/// Process noise of an object: the map's drift since its last detection. The angle about an axis of
/// symmetry is not observed, so its variance is added as well.
void MultiObjectState::add_process_noise(TrackedObject& object) {
  const Matrix6d drifted = drift - object.drift;
  object.belief.add_noise(joint,
                          drifted + object.detector.sensor().symmetries.unobserved_covariance());
  object.drift = drift;
}

/// The camera and the leading hypotheses move by eq. (5) to (8), and every other hypothesis follows
/// the camera by eq. (9).
void MultiObjectState::move_poses(TrackedObject& object, const std::vector<PairUpdate>& updates,
                                  double log_evidence, std::vector<Alternative>& births) {
  ObjectBelief& belief = object.belief;
  const CameraMoments before{Vector6d::Zero(), joint.covariance(kCamera, kCamera)};
  const CameraAlternative alternative =
      belief.camera_alternative(updates, births, log_evidence, before.covariance);
  CameraMoments after;
  after.mean =
      joint.update(*belief.pose_index(), updates[*belief.leading()].posterior, alternative);
  after.covariance = joint.covariance(kCamera, kCamera);
  belief.follow_camera(updates, after);
  for (TrackedObject& other : objects) {
    if (&other != &object) other.belief.follow_camera(before, after);
  }
  for (Alternative& birth : births) follow_camera(birth.pose, before, after);
}

/// Counts the detection. With the first one of all the correlation length becomes larger than one;
/// the reported covariance stays.
void MultiObjectState::count_detection(TrackedObject& object) {
  const double factor = covariance_factor();
  object.detector.count_detection(now_s);
  if (detections() == 1) joint.covariance() *= factor / covariance_factor();
}

/// Eq. (2) to (4): every hypothesis is updated on its own pair with the camera.
std::vector<PairUpdate> MultiObjectState::update_pairs(const TrackedObject& object,
                                                       const SE3d& detected) const {
  return object.belief.observe(
      joint, detected, object.detector.sensor(), settings.camera_gain_noise,
      settings.has_odometry ? GainCovariance::update : GainCovariance::likelihood);
}

/// The weights are multiplied by the evidence, sum_c exp e_c of eq. (3).
void MultiObjectState::update_weights(TrackedObject& object,
                                      const std::vector<PairUpdate>& updates) const {
  const double log_clutter = object.detector.sensor().noise.log_clutter_density();
  object.belief.multiply_weights(updates, log_clutter);
  object.belief.update_scores(updates, log_clutter, settings.score_memory);
  object.belief.count_detection();
}

ObjectUpdateReport MultiObjectState::update(std::size_t j, const SE3d& detected) {
  TrackedObject& object = objects[j];
  ObjectBelief& belief = object.belief;
  count_detection(object);
  add_process_noise(object);
  const std::vector<PairUpdate> updates = update_pairs(object, detected);  // eq. (2) to (4)
  std::vector<Alternative> births = births_of(object, detected, updates);
  update_weights(object, updates);  // eq. (3)
  ObjectUpdateReport report{.started = !births.empty(), .log_evidence = belief.log_total(births)};

  // The leading hypothesis corrects the detector's noise, and all poses move, eq. (5) to (9).
  std::optional<std::uint64_t> led;
  if (const auto leading = belief.leading()) {
    led = belief.standing(*leading).id;
    describe(updates[*leading], report);
    object.detector.learn(updates[*leading], settings);
    move_poses(object, updates, report.log_evidence, births);
  }

  belief.add(joint, births);
  report.merges = reduce(object);
  const auto leading = belief.leading();
  report.changed_leader = leading && belief.standing(*leading).id != led;
  return report;
}

/// "Reduction": merges, the cap on the number of hypotheses, and the choice of the leading one.
/// Returns the number of merges.
std::size_t MultiObjectState::reduce(TrackedObject& object) {
  ObjectBelief& belief = object.belief;
  if (belief.size() == 0) return 0;
  const std::size_t merges = belief.merge(joint, object.detector.sensor().symmetries, merge_bounds);
  belief.normalise();
  belief.keep_best(settings.max_hypotheses, settings.protected_hypotheses);
  belief.normalise();
  belief.choose_leader(joint, settings.leader_margin);
  return merges;
}

}  // namespace posemix::internal
