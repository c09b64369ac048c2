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

namespace posemix {

std::vector<std::optional<SE3d>> detections_by_id(const std::vector<ObjectModel>& models,
                                                  const std::map<std::string, SE3d>& detections) {
  std::vector<std::optional<SE3d>> in_order(models.size());
  for (const auto& [id, pose] : detections) {
    const auto model = std::find_if(models.begin(), models.end(),
                                    [&](const ObjectModel& other) { return other.id == id; });
    if (model == models.end()) {
      std::vector<std::string_view> ids;
      for (const ObjectModel& known : models) ids.push_back(known.id);
      throw InvalidInput(
          fmt::format("there is no object '{}', expected one of: {}", id, fmt::join(ids, ", ")));
    }
    in_order[static_cast<std::size_t>(model - models.begin())] = pose;
  }
  return in_order;
}

TrackedObjects::TrackedObjects(std::vector<ObjectModel> models) : models_(std::move(models)) {
  std::vector<std::string> ids;
  std::set<std::string> taken;
  for (const ObjectModel& model : models_) {
    if (!taken.insert(model.id).second)
      throw InvalidInput(fmt::format("two object models have the id '{}'", model.id));
    ids.push_back(model.id);
  }
  ids_ = std::make_shared<const std::vector<std::string>>(std::move(ids));
}

void TrackedObjects::require(std::size_t object) const {
  if (object < size()) return;
  throw InvalidInput(fmt::format("there is no object {}; there are {}", object, size()));
}

void TrackedObjects::begin(const FrameInput& input) {
  if (input.detections.size() != size()) {
    throw InvalidInput(
        fmt::format("frame: {} detections for {} objects", input.detections.size(), size()));
  }
  if (frames_ > 0 && !(input.dt > 0.0 && std::isfinite(input.dt))) {
    throw InvalidInput(
        fmt::format("frame: dt is {} s, expected a positive and finite time", input.dt));
  }
  ++frames_;
}

}  // namespace posemix
