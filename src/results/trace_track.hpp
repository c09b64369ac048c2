// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "io/json_writer.hpp"
#include "posemix/slam/evaluation.hpp"

namespace posemix::internal {

inline constexpr int kPoseDigits = 9;
inline constexpr int kCompactDigits = 7;

/// A number with few digits; null if it is not finite or missing.
Json compact_number(const std::optional<double>& number);

using Truths = std::vector<std::optional<SE3d>>;

/// One pose over the frames, with its truth: a part of trace.json.
class TraceTrackWriter {
 public:
  /// `density(frame)` is a pointer to that of a frame, null where there is none. A truth becomes
  /// the equivalent one that is nearest to the estimate, where there is one.
  template <class Density>
  TraceTrackWriter(const SlamRun& run, const ErrorReduction& reduction, Truths truths,
                   const Density& density)
      : truths_(std::move(truths)) {
    densities_.reserve(run.frames.size());
    for (const FrameEstimate& frame : run.frames) densities_.push_back(density(frame));
    compare(reduction);
  }

  void write(JsonWriter& out) const;
  bool has_truth() const { return has_truth_; }

 private:
  void compare(const ErrorReduction& reduction);

  std::vector<const PoseDensity*> densities_;
  Truths truths_;
  std::vector<std::optional<double>> nees_;
  bool has_truth_ = false;
};

}  // namespace posemix::internal
