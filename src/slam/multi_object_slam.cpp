// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/multi_object_slam.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "association_gates.hpp"
#include "filter/multi_object/filter_checks.hpp"
#include "observation_order.hpp"
#include "posemix/base/error.hpp"
#include "posemix/base/stopwatch.hpp"
#include "slam/frames.hpp"
#include "slam/motion.hpp"
#include "slam/searched_image.hpp"

namespace posemix {
namespace {

ObjectSensor sensor_of(const ObjectModel& object) {
  if (object.independent_start) {
    throw InvalidInput(fmt::format(
        "object '{}' has an independent start, which the multi-object filter does not have",
        object.id));
  }
  ObjectSensor sensor{object.noise, object.symmetries};
  for (const auto& [name, noise] : object.detectors) sensor.other_detectors.push_back(noise);
  return sensor;
}

/// Index of the noise of the named detector: zero for the object's own, then those of
/// ObjectModel::detectors in their order.
std::size_t detector_of(const ObjectModel& object, const std::string& name) {
  if (name.empty() || object.detectors.empty()) return 0;
  const auto found = object.detectors.find(name);
  if (found != object.detectors.end())
    return 1 + static_cast<std::size_t>(std::distance(object.detectors.begin(), found));
  std::vector<std::string_view> names;
  names.reserve(object.detectors.size());
  for (const auto& [known, noise] : object.detectors) names.push_back(known);
  throw InvalidInput(fmt::format("object '{}' has no detector '{}', expected one of: {}", object.id,
                                 name, fmt::join(names, ", ")));
}

/// One that moves has a place, and is never seen there.
void add_to(MultiObjectFilter& filter, const ObjectModel& object) {
  if (has_own_track(object.motion)) {
    filter.add_object(sensor_of(object));
  } else {
    filter.add_object(sensor_of(object), object.prior, put_down_of(object.motion));
  }
}

MultiObjectFilter make_filter(const PoseDensity& camera, const std::vector<ObjectModel>& objects,
                              const MultiObjectSlamSettings& settings,
                              const MotionSettings& motion) {
  require_alike_in_class(objects);
  require_valid(settings.cameras);
  internal::gates_of(settings.association);
  const Matrix6d near = internal::seen_from_near(camera).covariance();
  if (settings.on_sight) {
    internal::require_precision(near, sensor_of(*settings.on_sight), "the pose of the camera");
  }
  MultiObjectSettings filter = settings.filter;
  filter.has_odometry = motion.model == MotionModel::odometry || motion.model == MotionModel::still;
  MultiObjectFilter made(camera, {}, filter);
  // The cameras before all objects.
  for (const BodyCamera& one : settings.cameras)
    if (!one.is_exact()) made.add_camera(one.prior());
  for (const ObjectModel& object : objects) {
    try {
      internal::require_precision(near, sensor_of(object), "the pose of the camera");
      add_to(made, object);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("object '{}': {}", object.id, error.what()));
    }
  }
  return made;
}

MovingObjects make_moving(const std::vector<ObjectModel>& objects,
                          const MultiObjectSlamSettings& settings) {
  MovingObjects moving(settings.moving, settings.frames);
  if (settings.on_sight && has_own_track(settings.on_sight->motion))
    moving.expect(*settings.on_sight);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    try {
      validate(objects[i].motion);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("object '{}': {}", objects[i].id, error.what()));
    }
    if (has_own_track(objects[i].motion)) moving.add(i, objects[i]);
  }
  return moving;
}

/// Index among the cameras that are not exact, for one that is not.
std::optional<std::size_t> extrinsic_of(const std::vector<BodyCamera>& cameras, std::size_t index) {
  if (cameras[index].is_exact()) return std::nullopt;
  const auto end = cameras.begin() + static_cast<std::ptrdiff_t>(index);
  return static_cast<std::size_t>(
      std::count_if(cameras.begin(), end, [](const auto& camera) { return !camera.is_exact(); }));
}

/// How the camera moves into a frame; at the first one only where its pose is given.
std::optional<internal::CameraStep> camera_step_of(const MotionSettings& motion, bool is_first,
                                                   const FrameInput& input) {
  if (!is_first) return internal::camera_step(motion, input);
  if (motion.model != MotionModel::given || !input.camera) return std::nullopt;
  return internal::camera_step(motion, {.camera = input.camera});
}

FrameReport empty_report(const FrameInput& input) {
  FrameReport report;
  report.candidates.assign(input.candidates.size(), {.status = CandidateStatus::dropped});
  report.observations.assign(input.observations.size(), {.status = CandidateStatus::dropped});
  return report;
}

}  // namespace

MultiObjectSlam::MultiObjectSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                                 const MultiObjectSlamSettings& settings,
                                 const MotionSettings& motion, bool record_hypotheses)
    : objects_(std::move(objects)),
      settings_(settings),
      motion_(internal::checked(motion)),
      record_hypotheses_(record_hypotheses),
      filter_(make_filter(camera, objects_.models(), settings_, motion_)),
      moving_(make_moving(objects_.models(), settings_)),
      tracks_(settings_.existence, settings_.health, settings_.confirming_detections,
              settings_.association.least_separation_m) {
  for (const ObjectModel& model : objects_.models())
    tracks_.add(model.prior.has_value(), class_of(model));
}

std::size_t MultiObjectSlam::add_object(ObjectModel model) {
  add_to(filter_, model);
  tracks_.add(model.prior.has_value(), class_of(model));
  if (has_own_track(model.motion)) moving_.add(objects_.size(), model);
  return objects_.add(std::move(model));
}

FrameEstimate MultiObjectSlam::step(const FrameInput& input) {
  const bool is_first = objects_.frames() == 0;
  objects_.check(input);
  moving_.check(input);
  FrameReport report = empty_report(input);
  std::vector<Seen> sightings = sightings_of(input, report);
  for (const std::string& image : input.images) check_image(image);
  const auto moved = camera_step_of(motion_, is_first, input);
  if (input.camera) check_camera(*input.camera);
  objects_.begin(input);
  forget_deleted();
  tracks_.begin(input.dt);
  look(input);
  const Stopwatch frame;
  const bool lasted = std::exchange(
      camera_lasts_, motion_.model != MotionModel::given || !input.camera.has_value());
  const auto before = camera_for_moving();
  if (moved) internal::predict(filter_, *moved);
  const auto predicted = camera_for_moving();
  moving_.begin(is_first ? 0.0 : input.dt, input.frames);

  report.statuses.assign(objects_.size(), DetectionStatus::none);
  report.nis.assign(objects_.size(), std::nullopt);
  const Stopwatch updates;
  // What moves is seen from the camera as it is known from what does not.
  for (const bool moving : {false, true}) {
    if (moving && before) follow_camera(*before, *predicted, lasted);
    for (std::size_t object = 0; object < input.detections.size(); ++object) {
      if (input.detections[object] && moving_.has(object) == moving)
        update(object, observation_of(*input.detections[object]), {}, report);
    }
    update_named(moving, sightings, report);
    update_by_class(moving, sightings, report);
  }
  report.update.update_seconds = updates.seconds();

  FrameEstimate estimate = frame_estimate(std::move(report));
  update_tracks(estimate);
  estimate.report.seconds = frame.seconds();
  return estimate;
}

void MultiObjectSlam::check_camera(const SE3d& world_camera) const {
  if (motion_.model != MotionModel::given) return;
  const Matrix6d covariance = world_camera.adjoint_congruence(motion_.noise.covariance);
  internal::require_precise(PoseDensity::trusted(world_camera, covariance), "pose of the camera");
}

std::vector<MultiObjectSlam::Seen> MultiObjectSlam::sightings_of(const FrameInput& input,
                                                                 FrameReport& report) {
  std::vector<Seen> sightings;
  for (std::size_t i = 0; i < input.observations.size(); ++i) {
    try {
      sightings.push_back({internal::with_ordered_components(input.observations[i]),
                           source_of(input.observations[i]), &report.observations[i]});
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("frame: observations[{}]: {}", i, error.what()));
    }
  }
  for (std::size_t i = 0; i < input.candidates.size(); ++i)
    sightings.push_back({observation_of(input.candidates[i]), {}, &report.candidates[i]});
  // Linearisation makes the order matter, and that of the input may be any.
  std::stable_sort(sightings.begin(), sightings.end(), [&](const Seen& a, const Seen& b) {
    return is_taken_before(a.observation, b.observation);
  });
  return sightings;
}

bool MultiObjectSlam::is_taken_before(const Observation& a, const Observation& b) const {
  const std::size_t first = objects_.find(a.object).value_or(objects_.size());
  const std::size_t second = objects_.find(b.object).value_or(objects_.size());
  return first != second ? first < second : internal::comes_before(a, b);
}

void MultiObjectSlam::check(const Observation& observation) const {
  TrackedObjects::check(observation, "observation");
  source_of(observation);
}

void MultiObjectSlam::check_image(const std::string& name) const {
  const internal::SearchedImage image = internal::searched_image(settings_.cameras, name);
  if (!image.detector) return;
  if (settings_.on_sight && settings_.on_sight->detectors.empty()) return;  // which takes any
  auto names = internal::names_of_detectors(objects_.models());
  if (names && settings_.on_sight)
    for (const auto& [detector, noise] : settings_.on_sight->detectors) names->insert(detector);
  internal::require_known_detector(image, names);
}

std::vector<ObservedObject> MultiObjectSlam::observed(const FrameInput& input) const {
  std::vector<ObservedObject> list;
  for (std::size_t object = 0; object < input.detections.size(); ++object) {
    if (input.detections[object])
      list.push_back({object, observation_of(*input.detections[object])});
  }
  std::vector<Observation> named;
  for (const Observation& observation : input.observations)
    if (objects_.find(observation.object))
      named.push_back(internal::with_ordered_components(observation));
  std::stable_sort(named.begin(), named.end(), [&](const Observation& a, const Observation& b) {
    return is_taken_before(a, b);
  });
  for (const Observation& one : named)
    list.push_back({*objects_.find(one.object), one, source_of(one)});
  return list;
}

std::vector<BodyCamera> MultiObjectSlam::estimated_cameras() const {
  std::vector<BodyCamera> cameras = settings_.cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto extrinsic = extrinsic_of(settings_.cameras, i);
    if (!extrinsic) continue;
    const ConcentratedGaussian<SE3d> known = filter_.extrinsic(*extrinsic);
    cameras[i].body_camera = known.mean();
    cameras[i].covariance = known.mean().inverse().adjoint_congruence(Matrix6d(known.covariance()));
  }
  return cameras;
}

ObservationSource MultiObjectSlam::source_of(const Observation& observation) const {
  ObservationSource source;
  if (const auto camera = index_of_camera(settings_.cameras, observation.camera)) {
    source.body_camera = settings_.cameras[*camera].body_camera;
    source.camera = extrinsic_of(settings_.cameras, *camera);
  }
  if (!observation.object.empty()) {
    const auto object = objects_.find(observation.object);
    if (!object && !settings_.on_sight) {
      throw InvalidInput(fmt::format("there is no object '{}', expected one of: {}",
                                     observation.object, fmt::join(*objects_.ids(), ", ")));
    }
    source.detector =
        detector_of(object ? objects_[*object] : *settings_.on_sight, observation.detector);
    return source;
  }
  for (const ObjectModel& model : objects_.models()) {
    if (class_of(model) != observation.class_id) continue;
    source.detector = detector_of(model, observation.detector);
    break;
  }
  return source;
}

void MultiObjectSlam::update(std::size_t object, const Observation& observation,
                             const ObservationSource& source, FrameReport& report) {
  const bool known = is_known(object);
  const ObjectUpdateReport update = update_filter(object, observation, source);
  tracks_.detected(object, {.camera = observation.camera,
                            .detector = observation.detector,
                            .of_class = observation.object.empty() && !observation.class_id.empty(),
                            .clutter_probability = update.clutter_probability,
                            .inlier_probability = update.inlier_probability,
                            .residual = update.residual});
  report.nis[object] = update.nis;
  report.update.log_evidence += update.log_evidence;
  report.merges += update.merges;
  report.statuses[object] = !known                             ? DetectionStatus::started
                            : update.started                   ? DetectionStatus::birth
                            : update.clutter_probability > 0.5 ? DetectionStatus::doubted
                                                               : DetectionStatus::used;
}

FrameEstimate MultiObjectSlam::frame_estimate(FrameReport report) const {
  const std::size_t count = objects_.size();
  std::vector<std::optional<std::size_t>> indices;
  indices.reserve(count);
  for (std::size_t object = 0; object < count; ++object) indices.push_back(pose_index(object));
  FrameEstimate frame{.camera = filter_.camera(),
                      .objects = {},
                      .relative = {},
                      .pose_indices = std::move(indices),
                      .report = std::move(report),
                      .ids = objects_.ids()};
  // A run keeps the estimates of all its frames: no room is left over.
  frame.objects.reserve(count);
  frame.relative.reserve(count);
  frame.mode_probabilities.reserve(count);
  for (auto& one : filter_.leading_estimates()) {
    frame.objects.push_back(one ? std::optional(one->world) : std::nullopt);
    frame.relative.push_back(one ? std::optional(one->relative) : std::nullopt);
  }
  for (std::size_t object = 0; object < count; ++object) {
    frame.mode_probabilities.push_back(
        frame.objects[object] ? std::optional(filter_.mode_probability(object)) : std::nullopt);
    if (!record_hypotheses_) continue;
    std::vector<ObjectAlternative>& alternatives = frame.alternatives.emplace_back();
    for (const HypothesisMean& hypothesis : filter_.hypothesis_means(object))
      alternatives.push_back({hypothesis.probability, hypothesis.pose, hypothesis.id});
  }
  report_moving(frame);
  return frame;
}

}  // namespace posemix
