// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "messages.hpp"
#include "settings.hpp"

/// The graph of ROS 2, which is DDS with certain names of topics and types.
namespace posemix::internal {

/// Thrown when the graph cannot be joined.
class GraphError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What goes on in the middleware.
struct GraphCounts {
  std::size_t publishers = 0;  ///< of what this program takes
  std::size_t unsent = 0;      ///< messages that subscriptions could not keep up with
};

/// The topics of `posemix live` in the domain of ROS_DOMAIN_ID, through Cyclone DDS, which is set
/// up by CYCLONEDDS_URI; with ROS_LOCALHOST_ONLY or ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST, and no
/// CYCLONEDDS_URI, over the loopback device alone.
class RosGraph {
 public:
  /// @throws GraphError, and InvalidInput for an environment variable that is not valid, or where
  /// the program is built without Cyclone DDS
  explicit RosGraph(const LiveSettings& settings);
  ~RosGraph();
  RosGraph(const RosGraph&) = delete;
  RosGraph& operator=(const RosGraph&) = delete;

  std::uint32_t domain() const;
  /// Waits until there is something to take, or the time is over.
  void wait(double timeout_s);

  // --- all that has come since the last time, in the order in which it came
  std::vector<RosDetections> take_detections(std::size_t source);
  std::vector<RosTransform> take_transforms(bool is_static);
  std::vector<RosTransform> take_odometry();
  std::vector<std::int64_t> take_clock();
  /// Whether a message came that asks to forget all.
  bool take_reset();

  void publish(const RosDetections& message);
  void publish(const std::vector<RosTransform>& message);
  void publish(const RosDiagnostics& message);

  GraphCounts counts() const;
  /// Publishers and subscriptions that were met since the last time, and that do not fit.
  std::vector<std::string> take_mismatches();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace posemix::internal
