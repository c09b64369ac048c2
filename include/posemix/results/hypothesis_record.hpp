// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "posemix/slam/job.hpp"

namespace posemix {

namespace internal {
class HypothesisTexts;
}

/// The recorded hypotheses of a run in a temporary file, as trace.json will have them. They need
/// most of the memory of a long run:
///
///   HypothesisRecord record(job, folder.scratch());
///   const SlamRun done = run(job, {.record_hypotheses = true,
///                                  .estimated = [&](FrameEstimate& frame) { record.take(frame);
///                                  }});
///   write_results(folder, job, done, evaluate(job, done), {.hypotheses = &record});
class HypothesisRecord {
 public:
  /// The temporary file has no name, and lies on the disk of `folder`.
  /// @throws OutputError when it cannot be created
  HypothesisRecord(const SlamJob& job, const std::filesystem::path& folder);
  ~HypothesisRecord();
  HypothesisRecord(const HypothesisRecord&) = delete;
  HypothesisRecord& operator=(const HypothesisRecord&) = delete;

  /// Moves the hypotheses of the next frame out of its estimate, and drops what no file has:
  /// reports of reductions, and the places of motions where nothing moves.
  /// @throws OutputError when the disk is full
  void take(FrameEstimate& frame);
  /// Frames taken so far.
  std::size_t frames() const;

  const internal::HypothesisTexts& texts() const { return *texts_; }

 private:
  std::unique_ptr<internal::HypothesisTexts> texts_;
};

}  // namespace posemix
