// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "posemix/lie/lie.hpp"

/// Transforms between frames as they come, over a window of time.
namespace posemix::internal {

/// Poses over a window of time, or one pose for all times.
class PoseLine {
 public:
  /// Poses that are older than the newest by more than the window are forgotten. A pose that comes
  /// with such a stamp tells that the clock has jumped back: then all others are.
  explicit PoseLine(std::int64_t window_ns) : window_ns_(window_ns) {}

  void add(std::int64_t stamp_ns, const SE3d& pose);
  /// From now on one pose for all times.
  void set(const SE3d& pose);
  bool is_static() const { return static_.has_value(); }
  bool is_empty() const { return poses_.empty() && !static_; }
  /// The pose at a time, on the geodesic between two that are no further apart than `max_gap_s`;
  /// none before the first and after the last.
  std::optional<SE3d> at(std::int64_t stamp_ns, double max_gap_s) const;

 private:
  std::int64_t window_ns_;
  std::map<std::int64_t, SE3d> poses_;
  std::optional<SE3d> static_;
};

/// The tree of frames.
class FrameTree {
 public:
  explicit FrameTree(double window_s);

  /// Takes T_parent_child at a time, or without a stamp for all times. A child that gets another
  /// parent is from now on below that one alone.
  void add(const std::string& parent, const std::string& child,
           std::optional<std::int64_t> stamp_ns, const SE3d& pose);
  /// Forgets all but what holds for all times.
  void clear();
  /// The parent of a frame; empty: it has none.
  std::string parent(const std::string& frame) const;
  /// The last of the frames above a frame, or itself.
  std::string root(const std::string& frame) const;
  /// T_target_source at a time; none where it is not known.
  std::optional<SE3d> at(const std::string& target, const std::string& source,
                         std::int64_t stamp_ns, double max_gap_s) const;

 private:
  struct Link {
    std::string parent;
    PoseLine line;
  };

  /// The frame and all above it; only itself where they form a ring.
  std::vector<std::string> ancestors(const std::string& frame) const;

  std::int64_t window_ns_;
  std::map<std::string, Link> links_;
};

/// The window of so many seconds [ns].
std::int64_t nanoseconds(double seconds);

}  // namespace posemix::internal
