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

/// Whether the filters can compute with the pose: powers of its translation must be finite too.
bool is_usable(const SE3d& pose) {
  constexpr double kLargestPosition = 1e50;
  return pose.translation().cwiseAbs().maxCoeff() <= kLargestPosition &&
         pose.translation().allFinite() && pose.rotation().quaternion().coeffs().allFinite();
}

[[noreturn]] void refuse(const std::string& name) {
  throw InvalidInput(fmt::format("frame: {} is not finite, or is beyond 1e50 m", name));
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
  if (object < size()) return;
  throw InvalidInput(fmt::format("there is no object {}; there are {}", object, size()));
}

void TrackedObjects::check(const FrameInput& input) const {
  if (!input.detections.empty() && input.detections.size() != size()) {
    throw InvalidInput(
        fmt::format("frame: {} detections for {} objects", input.detections.size(), size()));
  }
  if (frames_ > 0 && !(input.dt > 0.0 && std::isfinite(input.dt))) {
    throw InvalidInput(
        fmt::format("frame: dt is {} s, expected a positive and finite time", input.dt));
  }
  if (input.motion && !is_usable(*input.motion)) refuse("the motion");
  if (input.camera && !is_usable(*input.camera)) refuse("the pose of the camera");
  for (std::size_t object = 0; object < input.detections.size(); ++object) {
    const auto& detection = input.detections[object];
    if (detection && !is_usable(*detection))
      refuse(fmt::format("the detection of '{}'", models_[object].id));
  }
  for (std::size_t i = 0; i < input.candidates.size(); ++i) {
    if (!is_usable(input.candidates[i].camera_object)) refuse(fmt::format("candidate {}", i));
    if (std::isnan(input.candidates[i].score))
      throw InvalidInput(fmt::format("frame: the score of candidate {} is not a number", i));
  }
  for (std::size_t i = 0; i < input.observations.size(); ++i)
    check(input.observations[i], fmt::format("frame: observations[{}]", i));
}

void TrackedObjects::check(const Observation& observation, const std::string& name) {
  try {
    validate(observation);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, error.what()));
  }
  for (std::size_t k = 0; k < observation.components.size(); ++k) {
    if (is_usable(observation.components[k].pose)) continue;
    throw InvalidInput(
        fmt::format("{}: components[{}].pose is not finite, or is beyond 1e50 m", name, k));
  }
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
