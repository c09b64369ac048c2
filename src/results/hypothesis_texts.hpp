// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>

#include "io/json_numbers.hpp"
#include "io/unnamed_file.hpp"
#include "posemix/slam/job.hpp"

namespace posemix::internal {

/// The heaviest joint hypotheses of a frame, for trace.json.
Json joint_hypotheses_json(const FrameEstimate& frame, std::size_t most);

/// The most probable alternatives of one object at one frame.
Json alternatives_json(std::vector<ObjectAlternative> list, std::size_t most);

/// The entries of the arrays `hypotheses` and `alternatives` of trace.json over the frames.
class HypothesisTexts {
 public:
  HypothesisTexts(const SlamJob& job, const std::filesystem::path& folder)
      : most_(job.trace_hypotheses),
        objects_(job.models.size()),
        texts_(folder, 1 + job.models.size()) {}

  void take(FrameEstimate& frame);
  std::size_t frames() const { return frames_; }
  /// Whether a frame had alternatives.
  bool has_alternatives() const { return alternatives_ > 0; }
  /// The entries with commas between them.
  void copy_joint(const TextSink& sink) const { texts_.copy(0, sink); }
  void copy_alternatives(std::size_t object, const TextSink& sink) const {
    texts_.copy(1 + object, sink);
  }

 private:
  std::size_t most_;
  std::size_t objects_;
  GrowingTexts texts_;
  std::size_t frames_ = 0;
  std::size_t alternatives_ = 0;  ///< frames that have them
};

}  // namespace posemix::internal
