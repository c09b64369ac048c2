// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "multi_object_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "posemix/base/statistics.hpp"
#include "posemix/filter/multi_object_ranges.hpp"
#include "posemix/filter/update.hpp"

namespace posemix::internal {
namespace {

void check_settings(const MultiObjectSettings& s) {
  require(s.max_hypotheses > 0, "max_hypotheses is 0, expected at least 1");
  require(s.max_global_hypotheses > 0, "max_global_hypotheses is 0, expected at least 1");
  for (const auto& [name, field, range] : kMultiObjectNumbers)
    range.check(s.*field, std::string(name));
}

/// The noise, with clutter of a default weight where it has none.
DetectorNoise with_clutter(const DetectorNoise& noise, double weight) {
  if (noise.clutter().weight > 0.0 || weight == 0.0) return noise;
  const double relative = weight / (1.0 - weight);  // to the components, whose weights sum to one
  return DetectorNoise(noise.components(),
                       {.weight = relative, .volume_m3 = noise.clutter().volume_m3},
                       noise.dependence());
}

/// The noise with offsets nearest to none under the symmetries: a mode of the detector that looks
/// the same as the true pose is no other mode.
DetectorNoise with_reduced_offsets(const DetectorNoise& noise, const SymmetryGroup& symmetries) {
  if (symmetries.is_trivial()) return noise;
  std::vector<NoiseComponent> components = noise.components();
  for (NoiseComponent& component : components)
    component.offset = symmetries.closest(component.offset, SE3d(), Matrix6d::Identity());
  return DetectorNoise(std::move(components), noise.clutter(), noise.dependence());
}

void describe(const DetectionUpdate& leader, ObjectUpdateReport& report) {
  report.inlier_probability = leader.inlier_probability();
  report.clutter_probability = leader.explanation.clutter_probability;
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
  for (ObjectSensor& sensor : sensors) {
    sensor.noise = with_clutter(with_reduced_offsets(sensor.noise, sensor.symmetries),
                                settings.default_clutter);
    objects.push_back({LearnedSensor(std::move(sensor))});
  }
}

GainFactors MultiObjectState::gain_factors(const TrackedObject& object) const {
  // A considered camera is one for every detection.
  if (settings.has_odometry && settings.camera_gain == 0.0)
    return {.camera = 0.0, .slow = is_damped(object) ? settings.slow_error_gain : 1.0};
  if (!is_damped(object)) return {};
  const auto leading = object.belief.leading();
  if (!leading) return {.camera = settings.camera_gain, .slow = settings.slow_error_gain};
  // Where the predicted pose is less certain than the detection, damping would only keep it wrong:
  // the gain is full by the square of the predicted pose's part of the innovation's variance.
  const DetectionState state = object.belief.state(joint, *leading);
  const ObjectSensor& sensor = object.detector.sensor();
  const NoiseComponent& inlier = sensor.noise.components().front();
  const Matrix6d predicted = state.difference();
  Matrix6d innovation = predicted + white_covariance(state, inlier, sensor);
  if (const auto slow = sensor.slow_covariance()) {
    const Matrix6d a = slow_error_map(state, inlier);
    innovation += a * *slow * a.transpose();
  }
  const double unknown = Eigen::LLT<Matrix6d>(innovation).solve(predicted).trace() / 6.0;
  const double full = std::pow(std::clamp(unknown, 0.0, 1.0), 2);
  return {.camera = settings.camera_gain + (1.0 - settings.camera_gain) * full,
          .slow = settings.slow_error_gain};
}

void MultiObjectState::advance(double dt, const std::optional<SE3d>& camera_before) {
  now_s += dt;
  for (TrackedObject& object : objects) {
    const ObjectSensor& sensor = object.detector.sensor();
    if (const auto& slow = sensor.noise.dependence().slow)
      object.belief.decay_slow_error(joint, *slow, *sensor.slow_covariance(), camera_before, dt);
  }
}

void MultiObjectState::erase(std::size_t pose_index) {
  const std::size_t blocks = joint.blocks_of(pose_index);
  joint.erase(pose_index);
  for (TrackedObject& other : objects) other.belief.move_pose_index_up(pose_index, blocks);
  if (motion && *motion > pose_index) *motion -= blocks;
}

void MultiObjectState::forget(std::size_t j) {
  TrackedObject& object = objects[j];
  if (const auto index = object.belief.pose_index()) erase(*index);
  object.detector.reset();
  object = {std::move(object.detector)};
}

/// The scale of the noise is learned. Where the slow error's changes by a factor f, b becomes f b,
/// and the object takes the difference, A (1 - f) b: what a detection sees of both stays.
void MultiObjectState::learn(TrackedObject& object, const DetectionUpdate& leading) {
  const Vector6d factor = object.detector.learn(leading, settings);
  const ObjectSensor& sensor = object.detector.sensor();
  if (!sensor.noise.dependence().slow || factor.isOnes(1e-12)) return;
  object.belief.rescale_slow_error(joint, sensor.noise.components().front(), factor);
}

/// The camera and the leading hypotheses move by eq. (5) to (8), and every other hypothesis follows
/// the camera by eq. (9).
void MultiObjectState::move_poses(TrackedObject& object,
                                  const std::vector<DetectionUpdate>& updates,
                                  const GainFactors& factors, double log_evidence,
                                  std::vector<Alternative>& births) {
  ObjectBelief& belief = object.belief;
  const CameraMoments before{Vector6d::Zero(), joint.covariance(kCamera, kCamera)};
  const CameraAlternative alternative =
      belief.camera_alternative(updates, births, log_evidence, before.covariance);
  CameraMoments after;
  const CameraChange change = joint.update(
      *belief.pose_index(), updates[*belief.leading()].explanation, alternative, factors);
  after.mean = change.mean;
  after.covariance = joint.covariance(kCamera, kCamera);
  belief.follow_camera(updates, after);
  for (TrackedObject& other : objects) {
    if (&other != &object) other.belief.follow_camera(before, after);
  }
  for (Alternative& birth : births) follow_camera(birth.pose, before, after);
  shift_back(object, change, births);
}

/// Eq. (10): a shift of the world takes a part of the camera's correction back, so that all poses
/// relative to each other stay as they are.
void MultiObjectState::shift_back(const TrackedObject& detected, const CameraChange& change,
                                  std::vector<Alternative>& births) {
  Vector6d taken;
  taken.head<3>().setConstant(1.0 - settings.camera_rotation_correction);
  taken.tail<3>().setConstant(1.0 - settings.camera_position_correction);
  if (!is_damped(detected) || taken.isZero(0.0)) return;
  const SE3d& at = joint.pose(kCamera);
  const Matrix6d back = at.adjoint() * taken.asDiagonal() * at.inverse().adjoint();
  const Matrix6d camera = joint.covariance(kCamera, kCamera);
  joint.shift_back(change, back);
  for (TrackedObject& object : objects)
    object.belief.shift_back(change, back, camera, &object == &detected);
  for (Alternative& birth : births) {
    internal::shift_back(birth.pose, change, back,
                         regression_on_camera(birth.pose.cross_covariance, camera));
  }
}

/// The weights are multiplied by the evidence, sum_c exp e_c of eq. (3).
void MultiObjectState::update_weights(TrackedObject& object,
                                      const std::vector<DetectionUpdate>& updates,
                                      double share) const {
  const double log_clutter = object.detector.sensor().noise.log_clutter_density();
  object.belief.multiply_weights(updates, log_clutter, share);
  object.belief.update_scores(updates, log_clutter, settings.score_memory);
  object.belief.count_detection();
}

ObservedDetection MultiObjectState::observe(std::size_t j, const SE3d& detected) const {
  const TrackedObject& object = objects[j];
  const GainFactors factors = gain_factors(object);
  ObservedDetection result{
      detected,
      object.belief.observe(joint, detected, object.detector.sensor(), factors),  // eq. (2) to (4)
      factors, false};
  result.is_explained =
      std::any_of(result.updates.begin(), result.updates.end(), [&](const DetectionUpdate& update) {
        return update.explanation.squared_distance < explained;
      });
  return result;
}

ObjectUpdateReport MultiObjectState::update(std::size_t j, const ObservedDetection& observed,
                                            bool may_start, LogTotals& evidence) {
  TrackedObject& object = objects[j];
  object.last_update = ++update_count;
  ObjectBelief& belief = object.belief;
  const ObjectSensor& sensor = object.detector.sensor();
  const std::vector<DetectionUpdate>& updates = observed.updates;
  const double share = object.detector.count_detection(now_s);
  std::vector<Alternative> births;
  if (may_start) births = births_of(object, observed.detected, share);
  update_weights(object, updates, share);  // eq. (3)
  ObjectUpdateReport report{.started = !births.empty(), .log_evidence = belief.log_total(births)};

  // All poses move, eq. (5) to (9), and the leading hypothesis corrects the detector's noise.
  std::optional<std::uint64_t> led;
  if (const auto leading = belief.leading()) {
    led = belief.standing(*leading).id;
    describe(updates[*leading], report);
    move_poses(object, updates, observed.factors, report.log_evidence, births);
    learn(object, updates[*leading]);
  }

  belief.add(joint, births);
  evidence = belief.normalise();
  report.merges = reduce(object);
  belief.fix_unobserved(joint, sensor.symmetries);
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
  belief.keep_best(settings.max_hypotheses, settings.protected_hypotheses);
  belief.normalise();
  belief.choose_leader(joint, settings.leader_margin);
  return merges;
}

}  // namespace posemix::internal
