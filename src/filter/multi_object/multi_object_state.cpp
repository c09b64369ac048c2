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

const ObservationComponent& heaviest(std::span<const ObservationComponent> components) {
  return *std::max_element(components.begin(), components.end(),
                           [](const auto& a, const auto& b) { return a.weight < b.weight; });
}

/// From one slow error to another of which it is the same process: L_b L_a^-1.
Matrix6d units_between(const Matrix6d& a, const Matrix6d& b) {
  const Eigen::LLT<Matrix6d> from(a);
  const Eigen::LLT<Matrix6d> to(b);
  return Matrix6d(to.matrixL()) * from.matrixL().solve(Matrix6d::Identity());
}

/// The detectors of an object, each as a sensor: all have the slow error of the first of them that
/// has one, in units of their own.
std::vector<ObjectSensor> sensors_of(const ObjectSensor& object, double default_clutter) {
  std::vector<DetectorNoise> noises{object.noise};
  noises.insert(noises.end(), object.other_detectors.begin(), object.other_detectors.end());
  const auto first = std::find_if(noises.begin(), noises.end(), [](const DetectorNoise& noise) {
    return noise.dependence().slow.has_value();
  });
  std::vector<ObjectSensor> sensors;
  for (auto noise = noises.begin(); noise != noises.end(); ++noise) {
    ObjectSensor one = object;
    one.other_detectors.clear();
    one.noise = with_clutter(with_reduced_offsets(*noise, object.symmetries), default_clutter);
    if (first != noises.end() && noise != first) {
      NoiseDependence shared = noise->dependence();
      shared.slow = first->dependence().slow;
      one.slow_units = Matrix6d::Zero();
      if (const auto& own = noise->dependence().slow)
        one.slow_units = units_between(shared.slow->covariance, own->covariance);
      one.noise = DetectorNoise(one.noise.components(), one.noise.clutter(), shared);
    }
    sensors.push_back(std::move(one));
  }
  return sensors;
}

void describe(const DetectionUpdate& leader, ObjectUpdateReport& report) {
  report.inlier_probability = leader.inlier_probability();
  report.clutter_probability = leader.explanation.clutter_probability;
  report.nis = leader.nis();
  report.residual = leader.white_residual();
}

}  // namespace

MultiObjectState::MultiObjectState(const ConcentratedGaussian<SE3d>& camera,
                                   const std::vector<ObjectSensor>& sensors,
                                   const MultiObjectSettings& given)
    : settings(given),
      explained(chi_square_quantile(given.explained_probability, 6, "explained_probability")),
      merge_bounds{given.merge_rotation_rad, given.merge_translation_m,
                   chi_square_quantile(given.merge_probability, 6, "merge_probability")},
      joint(ConcentratedGaussian<SE3d>(camera.mean(), kLeftOfWorld * camera.covariance())),
      world_error((1.0 - kLeftOfWorld) * camera.covariance()) {
  check_settings(settings);
  for (const ObjectSensor& sensor : sensors) add_object(sensor);
}

void MultiObjectState::add_object(const ObjectSensor& sensor,
                                  const std::optional<ObjectPrior>& prior,
                                  const std::optional<PutDownMotion>& put_down) {
  objects.emplace_back();
  TrackedObject& object = objects.back();
  for (ObjectSensor& one : sensors_of(sensor, settings.default_clutter))
    object.detectors.emplace_back(std::move(one));
  if (put_down && put_down->jump_rate > 0.0) {
    std::vector<DetectorModes> modes;
    modes.reserve(object.detectors.size());
    for (const LearnedSensor& detector : object.detectors)
      modes.emplace_back(detector.sensor().noise);
    object.put_down = std::make_shared<const PutDown>(PutDown{*put_down, std::move(modes)});
    object.belief.begin_unseen(object.put_down->unseen());
  }
  if (!prior) return;
  take_in_world_error();
  has_known_objects = true;
  ConditionalPose pose{prior->world.mean(), {}, Matrix12d::Zero(), Matrix12x6d::Zero()};
  pose.covariance.topLeftCorner<6, 6>() = prior->world.covariance();
  pose.extrinsics.setZero(12, offset(joint.extrinsics()));
  if (const auto slow = object.sensor().slow_covariance()) {
    pose.slow = Vector6d::Zero();
    pose.covariance.bottomRightCorner<6, 6>() = *slow;
  }
  const double log_weight = std::log(prior->probability);
  object.belief.add(
      joint, {{{.log_weight = log_weight,
                .log_probability = log_weight,
                .score = settings.birth_score,
                .id = next_id++,
                .shown = object.put_down ? object.put_down->unseen() : std::vector<ModeWeights>()},
               pose}});
  object.belief.set_log_absent(std::log1p(-prior->probability));
  object.belief.fix_unobserved(joint, object.sensor().symmetries);
}

GainFactors MultiObjectState::gain_factors(const TrackedObject& object,
                                           const WeighedObservation& observation) const {
  const ObjectSensor& sensor = object.detectors[observation.source.detector].sensor();
  // A considered camera is one for every detection.
  if (settings.has_odometry && settings.camera_gain == 0.0)
    return {.camera = 0.0,
            .slow = is_damped(sensor) ? settings.slow_error_gain : 1.0,
            .are_whole = false};
  if (!is_damped(sensor)) return {};
  const auto leading = object.belief.leading();
  if (!leading) {
    return {.camera = settings.camera_gain, .slow = settings.slow_error_gain, .are_whole = false};
  }
  // Where the predicted pose is less certain than the detection, damping would only keep it wrong:
  // the gain is full by the square of the predicted pose's part of the innovation's variance.
  const DetectionState state = object.belief.state_from(joint, *leading, observation.source);
  const NoiseComponent& inlier = sensor.noise.components().front();
  const Matrix6d predicted = state.difference();
  Matrix6d innovation =
      predicted + white_covariance(state, heaviest(observation.components), inlier, sensor);
  if (const auto slow = sensor.slow_covariance()) {
    const Matrix6d a = slow_error_map(state, inlier, sensor);
    innovation += a * *slow * a.transpose();
  }
  const double unknown = Cholesky6(innovation).solved_rows(predicted).trace() / 6.0;
  const double full = std::pow(std::clamp(unknown, 0.0, 1.0), 2);
  return {.camera = settings.camera_gain + (1.0 - settings.camera_gain) * full,
          .slow = settings.slow_error_gain,
          .are_whole = false};
}

KeptVector<OtherMomentsList> MultiObjectState::moments_of_others(bool released) {
  KeptVector<OtherMomentsList> moments;
  moments.reserve(objects.size());
  for (TrackedObject& object : objects)
    moments.push_back(object.belief.moments_of_others(joint, released));
  return moments;
}

void MultiObjectState::advance(double dt, const std::optional<SE3d>& camera_before,
                               const KeptVector<OtherMomentsList>& others) {
  now_s += dt;
  for (std::size_t j = 0; j < objects.size(); ++j) {
    TrackedObject& object = objects[j];
    const ObjectSensor& sensor = object.sensor();
    if (object.put_down) object.belief.leak(object.put_down->motion.jump_rate * dt);
    if (const auto& slow = sensor.noise.dependence().slow) {
      const Eigen::Vector3d turn = object.belief.decay_slow_error(
          joint, *slow, *sensor.slow_covariance(), camera_before, dt, others[j]);
      for (LearnedSensor& detector : object.detectors) detector.look(turn, dt);
    }
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
  for (LearnedSensor& detector : object.detectors) detector.reset();
  object = {std::move(object.detectors), std::move(object.put_down)};
  if (object.put_down) object.belief.begin_unseen(object.put_down->unseen());
}

/// The scale of the noise is learned. Where the slow error's changes by a factor f, b becomes f b,
/// and the object takes the difference, A (1 - f) b: what a detection sees of both stays.
void MultiObjectState::learn(TrackedObject& object, const DetectionUpdate& leading,
                             const WeighedObservation& observation) {
  const bool has_covariance =
      std::any_of(observation.components.begin(), observation.components.end(),
                  [](const auto& component) { return component.covariance.has_value(); });
  LearnedSensor& detector = object.detectors[observation.source.detector];
  const Vector6d factor = detector.learn(leading, has_covariance, settings, kLeastDetectorPart);
  const ObjectSensor& sensor = detector.sensor();
  if (!sensor.noise.dependence().slow || factor.isOnes(1e-12)) return;
  for (LearnedSensor& other : object.detectors) other.set_slow_scale(sensor.slow_scale);
  object.belief.rescale_slow_error(joint, sensor, factor);
}

/// The weights are multiplied by the evidence, sum_c exp e_c of eq. (3).
void MultiObjectState::update_weights(TrackedObject& object, const ObservedDetection& observed,
                                      double share) const {
  const double log_clutter = observed.observation.log_absence;
  object.belief.multiply_weights(observed.updates, log_clutter, share);
  object.belief.update_scores(observed.updates, log_clutter, settings.score_memory);
  object.belief.count_detection();
}

ObservedDetection MultiObjectState::observe(std::size_t j, const Observation& observation,
                                            const ObservationSource& source) const {
  const LearnedSensor& detector = objects[j].detectors[source.detector];
  WeighedObservation weighed =
      weigh(observation, detector.sensor(), detector.weight_share(observation, now_s), source);
  weighed.clarity = clarity(observation.components);
  return observe(j, std::move(weighed));
}

ObservedDetection MultiObjectState::observe(std::size_t j, WeighedObservation observation) const {
  const TrackedObject& object = objects[j];
  const ObservationSource source = observation.source;
  const LearnedSensor& detector = object.detectors[source.detector];
  const ObjectSensor& sensor = detector.sensor();
  ObservedDetection result{std::move(observation), {}, {}, {}, detector.new_share(now_s)};
  result.factors = gain_factors(object, result.observation);
  if (object.put_down) {
    const DetectorModes& modes = object.put_down->detectors[source.detector];
    const double stay =
        detector.detections() > 0 ? modes.persistence(detector.seconds_since(now_s)) : 0.0;
    const ShownModes shown{modes, source.detector, stay, result.observation.clutter};
    result.put_down = object.belief.observe_put_down(
        joint, result.observation, sensor, result.factors, shown, explained, result.updates);
  } else {
    result.updates =
        object.belief.observe(joint, result.observation, sensor, result.factors);  // eq. (2) to (4)
  }
  result.explained.assign(result.observation.components.size(), false);
  for (const DetectionUpdate& update : result.updates) {
    for (std::size_t k = 0; k < result.explained.size(); ++k) {
      if (update.explanation.squared_distances[k] < explained) result.explained[k] = true;
    }
  }
  return result;
}

ObjectUpdateReport MultiObjectState::update(std::size_t j, const ObservedDetection& observed,
                                            const Starters& may_start, LogTotals& evidence) {
  TrackedObject& object = objects[j];
  object.last_update = ++update_count;
  if (rig_motion) {
    rig_motion->see(observed.observation.source.camera);
    if (observed.observation.source.camera && !joint.is_linearised())
      joint.linearise_at(joint.pose(kCamera));
  }
  ObjectBelief& belief = object.belief;
  LearnedSensor& detector = object.detectors[observed.observation.source.detector];
  const DetectionUpdates& updates = observed.updates;
  const double share = detector.count_detection(observed.observation, now_s);
  Alternatives births;
  if (object.put_down) {
    births = take_in_put_down(object, observed, may_start);
  } else {
    births = births_of(object, observed.observation, may_start, share);
    update_weights(object, observed, share);  // eq. (3)
  }
  ObjectUpdateReport report{.started = !births.empty(), .log_evidence = belief.log_total(births)};

  // All poses move, eq. (5) to (9), and the leading hypothesis corrects the detector's noise.
  std::optional<std::uint64_t> led;
  if (const auto leading = belief.leading()) {
    led = belief.standing(*leading).id;
    describe(updates[*leading], report);
    move_poses(object, observed, is_damped(detector.sensor()), report.log_evidence, births);
    learn(object, updates[*leading], observed.observation);
  }

  belief.add(joint, births);
  evidence = belief.normalise();
  report.merges = reduce(object);
  belief.fix_unobserved_beside_camera(joint, object.sensor());
  const auto leading = belief.leading();
  report.changed_leader = leading && belief.standing(*leading).id != led;
  return report;
}

/// "Reduction": merges, the cap on the number of hypotheses, and the choice of the leading one.
/// Returns the number of merges.
std::size_t MultiObjectState::reduce(TrackedObject& object) {
  ObjectBelief& belief = object.belief;
  if (belief.size() == 0) return 0;
  const std::size_t merges = belief.merge(joint, object.sensor().symmetries, merge_bounds);
  belief.keep_best(settings.max_hypotheses, settings.protected_hypotheses);
  belief.normalise();
  belief.choose_leader(joint, settings.leader_margin);
  if (object.put_down) belief.forget_places();
  return merges;
}

}  // namespace posemix::internal
