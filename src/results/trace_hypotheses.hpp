// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trace_series.hpp"

namespace posemix::internal {

/// A hypothesis of one frame.
struct TraceHypothesis {
  std::int32_t id = 0;
  double probability = 0.0;
  TracePlace pose;
};

/// Hypotheses over the frames in slots. A hypothesis keeps its slot as long as it lives, so that
/// the values of a slot change little from frame to frame.
class HypothesisSlots {
 public:
  explicit HypothesisSlots(const TraceScales& scales) : scales_(scales) {}

  /// Adds the hypotheses of the next frame.
  void add(const std::vector<TraceHypothesis>& hypotheses);
  /// Compresses the slots as columns `prefix`/hypotheses/k/...
  void move_to(const std::string& prefix, std::vector<TraceColumn>& columns);

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

/// The alternatives of one object: columns `prefix`/hypotheses/k/...
TraceSeriesPtr alternatives_series(std::string path, const std::string& prefix,
                                   const TraceScales& scales);

/// Joint hypotheses: poses of the camera and of every object. They become hypotheses of
/// every entity separately, whose ids are their ranks.
class JointHypotheses final : public TraceSeries {
 public:
  JointHypotheses(std::string path, const TraceScales& scales)
      : TraceSeries(std::move(path)), scales_(scales) {}

  /// The entities of the poses ("camera", "objects/mug", ...), in their order.
  /// @throws InvalidInput when the number of poses is different
  void name(std::vector<std::string> prefixes);
  /// Call name() first.
  void move_to(std::vector<TraceColumn>& columns) override;

 private:
  void read(const TracePlace& place) override;

  TraceScales scales_;
  std::vector<std::string> prefixes_;
  std::vector<HypothesisSlots> slots_;  ///< one per pose; empty until the first hypothesis
};

}  // namespace posemix::internal
