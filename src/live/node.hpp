// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "complaints.hpp"
#include "engine.hpp"
#include "messages.hpp"
#include "outputs.hpp"
#include "ros_graph.hpp"
#include "settings.hpp"

namespace posemix::internal {

/// The node's clocks, and where its messages and lines of its log go.
struct LivePorts {
  std::function<double()> now_s;           ///< of a clock that does not jump
  std::function<std::int64_t()> clock_ns;  ///< of the clock that stamps are of, since 1970
  std::function<void(const RosDetections&)> objects;
  std::function<void(const std::vector<RosTransform>&)> transforms;
  std::function<void(const RosDiagnostics&)> diagnostics;
  std::function<void(const std::string&)> log;
};

/// Takes messages, publishes objects: all of `posemix live` but the middleware.
class LiveNode {
 public:
  /// The settings must outlive the node.
  /// @throws InvalidInput as LiveEngine
  LiveNode(const LiveSettings& settings, LivePorts ports, bool records = false);

  /// A message of the source at an index of the settings.
  void take_detections(std::size_t source, const RosDetections& message);
  void take_transforms(const std::vector<RosTransform>& message, bool is_static);
  void take_odometry(const RosTransform& message);
  /// A time of a simulated clock; one that steps back forgets all.
  void take_clock(std::int64_t clock_ns);
  /// Forgets all objects.
  void reset();
  /// Publishes what the next image says that need not wait any more. Returns whether there may be
  /// more of them.
  bool work();
  void diagnose(const GraphCounts& graph = {});
  void complain(const std::string& why, bool lasts = false);

  const LiveEngine& engine() const { return engine_; }

 private:
  /// Stamp of the last estimate in /tf [ns], and the frames that were sent with it: readers take
  /// one transform of a frame and a time.
  struct InTf {
    std::int64_t stamp_ns;
    std::set<std::string> frames;
  };

  void publish(const LiveEstimate& estimate);
  void publish_nothing();
  std::optional<FrameBelow> below_world(const LiveEstimate& estimate);
  /// The time by the clock of the robot, which may be simulated.
  std::int64_t clock_ns() const;
  void add_latencies(RosStatus& status) const;

  const LiveSettings* settings_;
  LivePorts ports_;
  LiveEngine engine_;
  Complaints complaints_;
  std::optional<LiveEstimate> last_;
  std::int64_t sim_clock_ns_ = 0;  ///< zero before the first
  std::size_t bad_ = 0;            ///< images that were complained of
  std::optional<InTf> in_tf_;
  std::deque<double> latencies_;  ///< from the arrival of images to the publication [s]
};

}  // namespace posemix::internal
