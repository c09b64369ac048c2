// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "class_table.hpp"
#include "recording.hpp"
#include "surroundings.hpp"

/// Images, odometry and transforms as they come, in; estimates, out. Without a clock of its own.
namespace posemix::internal {

/// What became of the images.
struct LiveCounts {
  std::size_t images = 0;        ///< taken in
  std::size_t observations = 0;  ///< in them
  std::size_t late = 0;          ///< observations out of order, taken in at their stamps
  std::size_t too_late = 0;      ///< observations that are older than the history
  std::size_t ignored = 0;  ///< of classes that no model has, or an object's second in an image
  std::size_t without_odometry = 0;  ///< images
  std::size_t dropped = 0;           ///< images: too many, or without the transform to their camera
  std::size_t refused = 0;           ///< images that are not valid, or whose stamps have jumped
  std::size_t resets = 0;
};

/// The estimate after an image.
struct LiveEstimate {
  std::int64_t stamp_ns;
  double arrival_s;  ///< of the image
  FrameEstimate frame;
  std::optional<SE3d> odometry;  ///< T_odom_body at the stamp
  /// Those of every object that was seen, the most probable first; empty for the others.
  std::vector<std::vector<ObjectHypothesis>> hypotheses;
  std::vector<std::string> classes;  ///< of all objects
};

/// Object SLAM by stamps over what a live system says.
class LiveEngine {
 public:
  /// The settings must outlive the engine. Images are kept for results where it `records`.
  /// @throws InvalidInput when a setting is out of range or models do not fit each other
  LiveEngine(const LiveSettings& settings, bool records);

  Surroundings& around() { return around_; }
  const Surroundings& around() const { return around_; }
  const LiveCounts& counts() const { return counts_; }
  /// Counts a message that was none.
  void refuse_message() { ++counts_.refused; }
  /// Why the last image was dropped, refused, or taken without odometry.
  const std::string& complaint() const { return complaint_; }
  /// Whether nothing was taken in since all was forgotten.
  bool is_empty() const { return !slam_; }
  /// Why all was forgotten the last time.
  const std::string& why_reset() const { return why_reset_; }
  std::size_t waiting() const { return waiting_.size(); }
  /// What was taken in as a job over a recording; none before the first image, and where no images
  /// are kept.
  std::optional<LiveResult> result() const;

  /// Takes an image, which waits until `ready` finds what it needs.
  void add(LiveImage image);
  /// The estimates after the images that need not wait any more, in the order of their stamps,
  /// `most` at once. `now_s` is of the clock of LiveImage::arrival_s.
  std::vector<LiveEstimate> ready(double now_s,
                                  std::size_t most = std::numeric_limits<std::size_t>::max());
  /// Forgets objects, odometry, and images that wait; transforms for all times are kept.
  void reset();

 private:
  void begin_again(const std::string& why);
  LiveImage take_out(std::size_t i);
  std::optional<LiveEstimate> settle(const std::optional<ReadyImage>& prepared);
  bool lacks_given_pose(const ReadyImage& ready) const;
  void start(const ReadyImage& ready);
  std::optional<LiveEstimate> take(const ReadyImage& ready);
  void put(const ReadyImage& ready);
  void refuse(const std::string& why);
  std::string jump_to(std::int64_t stamp_ns) const;
  std::optional<LiveEstimate> jump(const ReadyImage& ready, const std::string& why);
  std::optional<LiveEstimate> estimate(const LiveImage& image);
  std::vector<Observation> observations_of(const LiveImage& image, double stamp_s);
  double seconds(std::int64_t stamp_ns) const {
    return static_cast<double>(stamp_ns - start_ns_) * 1e-9;
  }

  const LiveSettings* settings_;
  Surroundings around_;
  LiveCounts counts_;
  std::string complaint_;
  std::string why_reset_;
  std::deque<LiveImage> waiting_;
  std::optional<StampedSlam> slam_;
  bool lacks_odometry_ = false;  ///< of the run: where it began the odometry was not known
  std::int64_t start_ns_ = 0;
  std::map<std::int64_t, std::optional<SE3d>> odometry_;  ///< of the images
  std::int64_t newest_ns_ = 0;
  std::size_t jumped_ = 0;  ///< images in succession whose stamps have jumped to one time
  std::int64_t jumped_to_ns_ = 0;
  ClassTable table_;
  LiveRecording recording_;
};

}  // namespace posemix::internal
