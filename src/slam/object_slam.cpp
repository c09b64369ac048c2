// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/object_slam.hpp"

#include <utility>

#include "posemix/base/error.hpp"

namespace posemix {
namespace {

MultiObjectSlam make_tracker(const PoseDensity& camera, std::vector<ObjectModel> objects,
                             const MultiObjectSlamSettings& tracker,
                             const ObjectSlamSettings& all) {
  return {camera, std::move(objects), tracker, all.motion, all.record_hypotheses};
}

GaussianSumSlam make_tracker(const PoseDensity& camera, std::vector<ObjectModel> objects,
                             const GaussianSumSettings& tracker, const ObjectSlamSettings& all) {
  return {camera, std::move(objects), tracker, all.motion, all.record_hypotheses};
}

ParticleSlam make_tracker(const PoseDensity& camera, std::vector<ObjectModel> objects,
                          const ParticleFilterSettings& tracker, const ObjectSlamSettings& all) {
  return {camera, std::move(objects), tracker, all.motion, all.record_hypotheses};
}

}  // namespace

ObjectSlam::ObjectSlam(const PoseDensity& camera, std::vector<ObjectModel> objects,
                       const ObjectSlamSettings& settings)
    : tracker_(std::visit(
          [&](const auto& tracker) -> Tracker {
            return make_tracker(camera, std::move(objects), tracker, settings);
          },
          settings.tracker)) {}

FrameEstimate ObjectSlam::step(const FrameInput& input) {
  return std::visit([&](auto& tracker) { return tracker.step(input); }, tracker_);
}

void ObjectSlam::forget(std::size_t object) {
  auto* tracker = std::get_if<MultiObjectSlam>(&tracker_);
  require(tracker != nullptr, "this tracker forgets no object, expected the multi-object filter");
  tracker->forget(object);
}

Posterior ObjectSlam::posterior() const {
  return std::visit([](const auto& tracker) { return tracker.posterior(); }, tracker_);
}

const Hypothesis& ObjectSlam::estimate() const {
  return std::visit([](const auto& tracker) -> const Hypothesis& { return tracker.estimate(); },
                    tracker_);
}

std::optional<std::size_t> ObjectSlam::pose_index(std::size_t object) const {
  return std::visit([&](const auto& tracker) { return tracker.pose_index(object); }, tracker_);
}

const std::vector<ObjectModel>& ObjectSlam::objects() const {
  return std::visit(
      [](const auto& tracker) -> const std::vector<ObjectModel>& { return tracker.objects(); },
      tracker_);
}

std::size_t ObjectSlam::detections(std::size_t object) const {
  return std::visit([&](const auto& tracker) { return tracker.detections(object); }, tracker_);
}

const MultiObjectFilter* ObjectSlam::multi_object() const {
  const auto* tracker = std::get_if<MultiObjectSlam>(&tracker_);
  return tracker != nullptr ? &tracker->filter() : nullptr;
}

}  // namespace posemix
