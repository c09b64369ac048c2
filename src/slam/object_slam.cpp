// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/object_slam.hpp"

#include <chrono>
#include <utility>

#include "frames.hpp"

namespace posemix {
namespace {

using Detections = std::vector<std::optional<SE3d>>;
using SlamClock = std::chrono::steady_clock;

double elapsed_s(SlamClock::time_point start) {
  return std::chrono::duration<double>(SlamClock::now() - start).count();
}

GaussianSumFilter gaussian_sum(const ConcentratedGaussian<SE3d>& camera,
                               const ObjectSlamSettings& settings) {
  Hypothesis start = internal::camera_hypothesis(camera, settings.motion);
  GaussianSumSettings filter = settings.filter;
  filter.first_object = start.mean().size();
  return {Posterior({{0.0, std::move(start)}}), filter};
}

MultiObjectFilter multi_object_filter(const ConcentratedGaussian<SE3d>& camera,
                                      const std::vector<ObjectModel>& objects,
                                      const ObjectSlamSettings& settings) {
  std::vector<ObjectSensor> sensors;
  for (const ObjectModel& object : objects) {
    if (object.independent_start) {
      throw InvalidInput(fmt::format(
          "object '{}' has an independent start, which the multi-object filter does not know",
          object.id));
    }
    sensors.push_back({object.noise, object.symmetries});
  }
  MultiObjectSettings filter = settings.multi_object;
  filter.has_odometry = settings.motion.model == MotionModel::odometry;
  return {camera, std::move(sensors), filter};
}

std::variant<GaussianSumFilter, MultiObjectFilter> make_filter(
    const ConcentratedGaussian<SE3d>& camera, const std::vector<ObjectModel>& objects,
    const ObjectSlamSettings& settings) {
  if (settings.kind == SlamFilter::gaussian_sum) return gaussian_sum(camera, settings);
  return multi_object_filter(camera, objects, settings);
}

Hypothesis summary_of(const std::variant<GaussianSumFilter, MultiObjectFilter>& filter) {
  if (const auto* sum = std::get_if<GaussianSumFilter>(&filter)) return sum->summarise();
  return std::get<MultiObjectFilter>(filter).joint();
}

}  // namespace

ObjectSlam::ObjectSlam(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectModel> objects,
                       const ObjectSlamSettings& settings)
    : objects_(std::move(objects)),
      motion_(settings.motion),
      filter_(make_filter(camera, objects_, settings)),
      indices_(objects_.size()),
      association_(settings.association),
      confirming_detections_(settings.confirming_detections),
      birth_covariance_factor_(settings.multi_object.birth_covariance_factor),
      sightings_(objects_.size()),
      estimate_(summary_of(filter_)) {
  require(motion_.period_s > 0.0, "motion: period_s must be positive");
}

FrameReport ObjectSlam::start(const Detections& detections,
                              const std::vector<Candidate>& candidates) {
  return observe(detections, candidates);
}

FrameReport ObjectSlam::step(const FrameInput& input) {
  if (!(input.dt > 0.0)) {
    throw InvalidInput(fmt::format("frame: dt is {} s, expected a positive time", input.dt));
  }
  const auto start = SlamClock::now();
  std::visit([&](auto& filter) { predict(filter, input); }, filter_);
  FrameReport report = observe(input.detections, input.candidates);
  report.seconds = elapsed_s(start);
  return report;
}

Posterior ObjectSlam::posterior() const {
  if (const auto* sum = std::get_if<GaussianSumFilter>(&filter_)) return sum->posterior();
  return Posterior({{0.0, estimate_}});
}

std::optional<std::size_t> ObjectSlam::pose_index(std::size_t object) const {
  const MultiObjectFilter* filter = multi_object();
  return filter != nullptr ? filter->pose_index(object) : indices_[object];
}

void ObjectSlam::predict(GaussianSumFilter& filter, const FrameInput& input) const {
  filter.predict([&](Hypothesis hypothesis) {
    return internal::moved(std::move(hypothesis), motion_, input);
  });
}

void ObjectSlam::predict(MultiObjectFilter& filter, const FrameInput& input) const {
  switch (motion_.model) {
    case MotionModel::odometry:
      if (input.odometry) {
        filter.predict_with_odometry(*input.odometry, motion_.noise.over(input.dt), input.dt);
      } else {
        filter.predict_random_walk(motion_.unknown_motion.over(input.dt), input.dt);
      }
      return;
    case MotionModel::random_walk:
      filter.predict_random_walk(motion_.walk.over(input.dt), input.dt);
      return;
    case MotionModel::constant_velocity:
      filter.predict_constant_velocity(input.dt / motion_.period_s, motion_.noise.over(input.dt),
                                       motion_.motion_noise.over(input.dt),
                                       motion_.motion_noise.over(motion_.period_s), input.dt);
      return;
  }
}

FrameReport ObjectSlam::observe(const Detections& detections,
                                const std::vector<Candidate>& candidates) {
  if (detections.size() != objects_.size()) {
    throw InvalidInput(
        fmt::format("frame: {} detections for {} objects", detections.size(), objects_.size()));
  }
  auto* multi_object = std::get_if<MultiObjectFilter>(&filter_);
  if (multi_object == nullptr && !candidates.empty()) {
    throw InvalidInput(
        fmt::format("frame: {} candidates for the Gaussian-sum filter, expected detections that "
                    "name their object, or the multi-object filter",
                    candidates.size()));
  }
  ++frame_;
  FrameReport report;
  report.statuses.assign(objects_.size(), DetectionStatus::none);
  std::visit([&](auto& filter) { observe(filter, detections, report); }, filter_);
  if (!candidates.empty()) {
    const auto start = SlamClock::now();
    observe_candidates(*multi_object, candidates, report);
    report.update.update_seconds += elapsed_s(start);
  }
  estimate_ = summary_of(filter_);
  return report;
}

void ObjectSlam::observe(MultiObjectFilter& filter, const Detections& detections,
                         FrameReport& report) {
  const auto start = SlamClock::now();
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (detections[object]) update(filter, object, *detections[object], report);
  }
  report.update.update_seconds = elapsed_s(start);
}

void ObjectSlam::update(MultiObjectFilter& filter, std::size_t object, const SE3d& detected,
                        FrameReport& report) {
  const bool known = filter.leading(object).has_value();
  const ObjectUpdateReport update = filter.update(object, detected);
  ++sightings_[object].count;
  sightings_[object].last_frame = frame_;
  report.update.log_evidence += update.log_evidence;
  report.merges += update.merges;
  report.statuses[object] = !known                             ? DetectionStatus::started
                            : update.started                   ? DetectionStatus::birth
                            : update.clutter_probability > 0.5 ? DetectionStatus::doubted
                                                               : DetectionStatus::used;
}

void ObjectSlam::observe(GaussianSumFilter& filter, const Detections& detections,
                         FrameReport& report) {
  // Update with the objects that are already in the map.
  std::vector<Detection> known;
  std::vector<std::size_t> known_objects;
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (!detections[object] || !indices_[object]) continue;
    ++sightings_[object].count;
    known.push_back({*indices_[object], *detections[object], &objects_[object].noise});
    known_objects.push_back(object);
  }
  report.update = filter.update(known);
  for (std::size_t i = 0; i < known.size(); ++i) {
    report.statuses[known_objects[i]] = report.update.gated[i]    ? DetectionStatus::gated
                                        : report.update.failed[i] ? DetectionStatus::failed
                                                                  : DetectionStatus::used;
  }
  for (const ReductionReport& reduction : report.update.reductions)
    report.merges += reduction.merges.size();

  // Objects seen for the first time enter the map.
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (!detections[object] || indices_[object]) continue;
    const ObjectModel& model = objects_[object];
    indices_[object] =
        model.independent_start
            ? filter.add_independent_object(*detections[object], *model.independent_start)
            : filter.add_object(*detections[object], model.noise);
    report.statuses[object] = DetectionStatus::started;
    ++sightings_[object].count;
  }
}

}  // namespace posemix
