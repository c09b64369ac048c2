// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "hypothesis_slots.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace posemix::internal {
namespace {

constexpr ColumnFormat kIdFormat{1, ColumnType::int32};
constexpr double kShare = 1.0 / 65535.0;
constexpr ColumnFormat kShareFormat{1, ColumnType::uint16, kShare};

std::array<double, 7> pose_of(const TraceHypothesis& hypothesis, const TraceScales& scales) {
  std::array<double, 7> pose;
  for (std::size_t i = 0; i < 3; ++i) pose[i] = scales.position_m * hypothesis.position[i];
  for (std::size_t i = 0; i < 4; ++i) pose[3 + i] = scales.quaternion * hypothesis.quaternion[i];
  return pose;
}

}  // namespace

HypothesisSlots::Slot::Slot(std::size_t index, const TraceScales& scales, std::size_t frames)
    : mask(fmt::format("/hypotheses/{}/mask", index), {}),
      ids(fmt::format("/hypotheses/{}/id", index), kIdFormat),
      probabilities(fmt::format("/hypotheses/{}/probability", index), kShareFormat),
      poses(fmt::format("/hypotheses/{}", index), scales) {
  mask.repeat_until(frames);
  ids.repeat_until(frames);
  probabilities.repeat_until(frames);
  poses.repeat_until(frames);
}

HypothesisSlots::Slot& HypothesisSlots::slot_of(std::int32_t id) {
  const auto has = [&](std::optional<std::int32_t> wanted) {
    return std::find_if(slots_.begin(), slots_.end(),
                        [&](const Slot& slot) { return slot.id == wanted; });
  };
  auto found = has(id);
  if (found == slots_.end()) found = has(std::nullopt);
  if (found == slots_.end()) return slots_.emplace_back(slots_.size(), scales_, frames_);
  return *found;
}

void HypothesisSlots::add(std::span<const TraceHypothesis> hypotheses) {
  for (Slot& slot : slots_) {
    const auto lives = [&](const TraceHypothesis& each) { return slot.id == each.id; };
    if (std::none_of(hypotheses.begin(), hypotheses.end(), lives)) slot.id.reset();
  }
  for (const TraceHypothesis& hypothesis : hypotheses) {
    Slot& slot = slot_of(hypothesis.id);
    slot.id = hypothesis.id;
    slot.ids.add(std::array{static_cast<double>(hypothesis.id)});
    slot.probabilities.add(std::array{kShare * hypothesis.probability});
    slot.poses.add(pose_of(hypothesis, scales_));
  }
  end_frame();
}

void HypothesisSlots::end_frame() {
  ++frames_;
  for (Slot& slot : slots_) {
    slot.mask.add(std::array{slot.id ? 1.0 : 0.0});
    slot.ids.repeat_until(frames_);
    slot.probabilities.repeat_until(frames_);
    slot.poses.repeat_until(frames_);
  }
}

std::vector<TraceColumn> HypothesisSlots::columns(const std::string& prefix) && {
  constexpr std::size_t kColumns = 5;
  std::vector<TraceColumn> columns;
  columns.reserve(kColumns * slots_.size());
  for (Slot& slot : slots_) {
    columns.push_back(std::move(slot.mask));
    columns.push_back(std::move(slot.ids));
    columns.push_back(std::move(slot.probabilities));
    std::move(slot.poses).move_to(columns);
  }
  for (TraceColumn& column : columns) column.put_before_name(prefix);
  return columns;
}

}  // namespace posemix::internal
