// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/tracker.hpp"

#include <set>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix {

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

void TrackedObjects::begin(const FrameInput& input) {
  if (input.detections.size() != size()) {
    throw InvalidInput(
        fmt::format("frame: {} detections for {} objects", input.detections.size(), size()));
  }
  if (frames_ > 0 && !(input.dt > 0.0)) {
    throw InvalidInput(fmt::format("frame: dt is {} s, expected a positive time", input.dt));
  }
  ++frames_;
}

}  // namespace posemix
