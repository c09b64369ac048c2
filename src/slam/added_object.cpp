// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/slam/multi_object_slam.hpp"
#include "trial_camera.hpp"

namespace posemix {

std::size_t MultiObjectSlam::add(ObjectModel model) {
  if (objects_.find(model.id)) {
    throw InvalidInput(
        fmt::format("there is an object '{}' already, expected another id", model.id));
  }
  std::vector<ObjectModel> models = objects_.models();
  models.push_back(model);
  require_alike_in_class(models);
  // A tracker of this model alone throws for one that is not valid, before anything changes.
  static_cast<void>(MultiObjectSlam(internal::trial_camera({model}), {model}, settings_, motion_));
  return add_object(std::move(model));
}

}  // namespace posemix
