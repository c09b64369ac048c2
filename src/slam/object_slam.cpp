// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/object_slam.hpp"

#include <chrono>
#include <utility>

#include "frames.hpp"

namespace posemix {
namespace {

GaussianSumFilter make_filter(const ConcentratedGaussian<SE3d>& camera,
                              const ObjectSlamSettings& settings) {
  Posterior start({{0.0, internal::camera_hypothesis(camera, settings.motion)}});
  FilterSettings filter = settings.filter;
  filter.first_object = start[0].density.mean().size();
  return {std::move(start), filter};
}

}  // namespace

ObjectSlam::ObjectSlam(const ConcentratedGaussian<SE3d>& camera, std::vector<ObjectModel> objects,
                       const ObjectSlamSettings& settings)
    : objects_(std::move(objects)),
      motion_(settings.motion),
      filter_(make_filter(camera, settings)),
      indices_(objects_.size()),
      estimate_(filter_.summarise()) {
  require(motion_.period_s > 0.0, "motion: period_s must be positive");
}

FrameReport ObjectSlam::start(const std::vector<std::optional<SE3d>>& detections) {
  return observe(detections);
}

FrameReport ObjectSlam::step(const FrameInput& input) {
  if (!(input.dt > 0.0)) {
    throw InvalidInput(fmt::format("frame: dt is {} s, expected a positive time", input.dt));
  }
  const auto start = std::chrono::steady_clock::now();
  predict(input);
  FrameReport report = observe(input.detections);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

void ObjectSlam::predict(const FrameInput& input) {
  filter_.predict([&](Hypothesis h) { return internal::moved(std::move(h), motion_, input); });
}

FrameReport ObjectSlam::observe(const std::vector<std::optional<SE3d>>& detections) {
  if (detections.size() != objects_.size()) {
    throw InvalidInput(
        fmt::format("frame: {} detections for {} objects", detections.size(), objects_.size()));
  }
  FrameReport report;
  report.fates.assign(objects_.size(), DetectionFate::none);

  // Update with the objects that are already in the map.
  std::vector<Detection> known;
  std::vector<std::size_t> known_objects;
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (!detections[object] || !indices_[object]) continue;
    known.push_back({*indices_[object], *detections[object], &objects_[object].noise});
    known_objects.push_back(object);
  }
  report.update = filter_.update(known);
  for (std::size_t i = 0; i < known.size(); ++i) {
    report.fates[known_objects[i]] = report.update.gated[i]    ? DetectionFate::gated
                                     : report.update.failed[i] ? DetectionFate::failed
                                                               : DetectionFate::used;
  }

  // Objects seen for the first time enter the map.
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (!detections[object] || indices_[object]) continue;
    const ObjectModel& model = objects_[object];
    indices_[object] =
        model.independent_start
            ? filter_.add_independent_object(*detections[object], *model.independent_start)
            : filter_.add_object(*detections[object], model.noise);
    report.fates[object] = DetectionFate::started;
  }
  estimate_ = filter_.summarise();
  return report;
}

}  // namespace posemix
