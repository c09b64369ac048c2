// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/frame_estimate.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"

namespace posemix {

std::size_t FrameEstimate::index_of(std::string_view id) const {
  static const std::vector<std::string> none;
  const std::vector<std::string>& known = ids ? *ids : none;
  const auto found = std::find(known.begin(), known.end(), id);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  throw InvalidInput(
      fmt::format("there is no object '{}', expected one of: {}", id,
                  known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
}

ObjectEstimate FrameEstimate::object(std::string_view id) const {
  const std::size_t i = index_of(id);
  ObjectEstimate estimate{.world = objects[i], .relative = relative[i]};
  if (!mode_probabilities.empty()) estimate.mode_probability = mode_probabilities[i];
  if (!alternatives.empty()) estimate.alternatives = alternatives[i];
  if (!report.statuses.empty()) estimate.status = report.statuses[i];
  if (!motion_models.empty()) estimate.motion_models = motion_models[i];
  if (!twists.empty()) estimate.twist = twists[i];
  return estimate;
}

}  // namespace posemix
