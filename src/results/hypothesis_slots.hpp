// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "trace_hypotheses.hpp"

namespace posemix::internal {

/// The hypotheses of one entity over the frames in slots.
class HypothesisSlots {
 public:
  explicit HypothesisSlots(const TraceScales& scales) : scales_(scales) {}

  /// Adds the hypotheses of the next frame.
  void add(std::span<const TraceHypothesis> hypotheses);
  /// The columns `prefix`/hypotheses/k/...
  std::vector<TraceColumn> columns(const std::string& prefix) &&;

 private:
  struct Slot {
    Slot(std::size_t index, const TraceScales& scales, std::size_t frames);

    std::optional<std::int32_t> id;  ///< id of the hypothesis in the slot
    TraceColumn mask;
    TraceColumn ids;
    TraceColumn probabilities;
    PoseColumns poses;
  };

  Slot& slot_of(std::int32_t id);
  void end_frame();

  TraceScales scales_;
  std::size_t frames_ = 0;
  std::vector<Slot> slots_;
};

}  // namespace posemix::internal
