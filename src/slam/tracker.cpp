// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/base/linear.hpp"
#include "posemix/lie/pose_checks.hpp"

namespace posemix {

std::vector<std::optional<SE3d>> detections_by_id(const std::vector<ObjectModel>& models,
                                                  const std::map<std::string, SE3d>& detections) {
  std::vector<std::optional<SE3d>> in_order(models.size());
  for (const auto& [id, pose] : detections) {
    // Clang before 16 cannot capture a structured binding without a name of its own.
    const auto model = std::find_if(models.begin(), models.end(),
                                    [&id = id](const auto& other) { return other.id == id; });
    if (model == models.end()) {
      std::vector<std::string_view> ids;
      ids.reserve(models.size());
      for (const ObjectModel& known : models) ids.push_back(known.id);
      throw InvalidInput(
          fmt::format("there is no object '{}', expected one of: {}", id, fmt::join(ids, ", ")));
    }
    in_order[static_cast<std::size_t>(model - models.begin())] = pose;
  }
  return in_order;
}

namespace {

/// Runs a check; what it refuses begins with a name, which is made only then.
template <class Name, class Check>
void naming(const Name& name, const Check& check) {
  try {
    check();
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name(), error.what()));
  }
}

}  // namespace

TrackedObjects::TrackedObjects(std::vector<ObjectModel> models) : models_(std::move(models)) {
  std::vector<std::string> ids;
  std::set<std::string> taken;
  for (const ObjectModel& model : models_) {
    if (!taken.insert(model.id).second)
      throw InvalidInput(fmt::format("two object models have the id '{}'", model.id));
    if (model.independent_start) {
      checked_covariance(*model.independent_start, 6,
                         fmt::format("independent start of object '{}'", model.id));
    }
    ids.push_back(model.id);
  }
  for (std::size_t object = 0; object < ids.size(); ++object) index_.emplace(ids[object], object);
  ids_ = std::make_shared<const std::vector<std::string>>(std::move(ids));
}

void TrackedObjects::require(std::size_t object) const {
  internal::check_index(object, size(), "object");
}

void TrackedObjects::check(const FrameInput& input) const {
  if (!input.detections.empty() && input.detections.size() != size()) {
    throw InvalidInput(
        fmt::format("frame: {} detections for {} objects", input.detections.size(), size()));
  }
  if (frames_ > 0 && !(input.dt > 0.0 && input.dt <= kLatestStamp)) {
    throw InvalidInput(
        fmt::format("frame: dt is {} s, expected a positive and finite time", input.dt));
  }
  if (input.motion) check_pose(*input.motion, "frame: the motion");
  if (input.camera) check_pose(*input.camera, "frame: the pose of the camera");
  for (std::size_t object = 0; object < input.detections.size(); ++object) {
    if (!input.detections[object]) continue;
    naming([&] { return fmt::format("frame: the detection of '{}'", models_[object].id); },
           [&] { check_pose(*input.detections[object], "the pose"); });
  }
  for (std::size_t i = 0; i < input.candidates.size(); ++i) {
    naming([&] { return fmt::format("frame: candidate {}", i); },
           [&] { check_pose(input.candidates[i].camera_object, "the pose"); });
    if (std::isnan(input.candidates[i].score))
      throw InvalidInput(fmt::format("frame: the score of candidate {} is not a number", i));
  }
  for (std::size_t i = 0; i < input.observations.size(); ++i)
    check(input.observations[i], fmt::format("frame: observations[{}]", i));
}

void TrackedObjects::check(const Observation& observation, const std::string& name) {
  naming([&] { return name; }, [&] { validate(observation); });
  if (observation.object.empty() == observation.class_id.empty()) {
    throw InvalidInput(fmt::format(
        "{}: has {}, expected one of them", name,
        observation.object.empty() ? "neither object nor class_id" : "both object and class_id"));
  }
}

std::optional<std::size_t> TrackedObjects::find(std::string_view id) const {
  const auto found = index_.find(id);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

std::size_t TrackedObjects::add(ObjectModel model) {
  std::vector<std::string> ids = *ids_;
  ids.push_back(model.id);
  index_.emplace(model.id, models_.size());
  models_.push_back(std::move(model));
  ids_ = std::make_shared<const std::vector<std::string>>(std::move(ids));
  return models_.size() - 1;
}

void TrackedObjects::begin(const FrameInput& input) {
  check(input);
  ++frames_;
}

}  // namespace posemix
