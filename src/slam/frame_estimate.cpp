// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/slam/frame_estimate.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posemix/base/error.hpp"
#include "posemix/base/range.hpp"

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
  const auto entry = [&](const auto& entries) {
    internal::check_index(i, entries.size(), "object");
    return entries[i];
  };
  ObjectEstimate estimate{.world = entry(objects), .relative = entry(relative)};
  if (!mode_probabilities.empty()) estimate.mode_probability = entry(mode_probabilities);
  if (!existences.empty()) estimate.existence = entry(existences);
  if (!healths.empty()) estimate.health = entry(healths);
  if (!register_again.empty()) estimate.register_again = entry(register_again);
  if (!alternatives.empty()) estimate.alternatives = entry(alternatives);
  if (!report.statuses.empty()) estimate.status = entry(report.statuses);
  if (!motion_models.empty()) estimate.motion_models = entry(motion_models);
  if (!twists.empty()) estimate.twist = entry(twists);
  return estimate;
}

}  // namespace posemix
