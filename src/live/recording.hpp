// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "posemix/slam/job.hpp"
#include "settings.hpp"

/// What a live run has taken in, for its results.
namespace posemix::internal {

/// A live run that has ended, as a job over what it has taken in.
struct LiveResult {
  SlamJob job;
  double start_s;  ///< of the stamps of the job, since 1970
};

/// An image as it was taken in.
struct RecordedImage {
  std::int64_t stamp_ns;
  std::optional<SE3d> odometry = {};
  std::vector<Observation> observations = {};
  std::optional<std::string> empty_of = {};  ///< an image that shows nothing, as FrameInput::images
};

/// The last images of a run.
class LiveRecording {
 public:
  /// Keeps so many images; zero: none.
  explicit LiveRecording(std::size_t images) : most_(images) {}

  void add(RecordedImage image);
  void clear() { images_.clear(); }
  bool is_empty() const { return images_.empty(); }
  const std::deque<RecordedImage>& images() const { return images_; }

 private:
  std::size_t most_;
  std::deque<RecordedImage> images_;
};

/// The images in the order of their stamps, which are seconds since the first that is kept, as a
/// recording of the objects that there are. Their ids are fit for names of files.
LiveResult result_of(const LiveRecording& recording, const LiveSettings& settings,
                     std::vector<ObjectModel> models, const std::vector<BodyCamera>& cameras);

}  // namespace posemix::internal
