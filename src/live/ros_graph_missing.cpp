// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/base/error.hpp"
#include "ros_graph.hpp"

/// The graph where Cyclone DDS was not found when this program was built.
namespace posemix::internal {

struct RosGraph::Parts {};

RosGraph::RosGraph(const LiveSettings&) {
  throw InvalidInput(
      "this program is built without Cyclone DDS, which joins the graph of ROS 2; expected one "
      "that "
      "is built where its headers and its compiler of IDL are (Debian: cyclonedds-dev, "
      "cyclonedds-tools)");
}
RosGraph::~RosGraph() = default;
std::uint32_t RosGraph::domain() const { return 0; }
void RosGraph::wait(double) {}
std::vector<RosDetections> RosGraph::take_detections(std::size_t) { return {}; }
std::vector<RosTransform> RosGraph::take_transforms(bool) { return {}; }
std::vector<RosTransform> RosGraph::take_odometry() { return {}; }
std::vector<std::int64_t> RosGraph::take_clock() { return {}; }
bool RosGraph::take_reset() { return false; }
void RosGraph::publish(const RosDetections&) {}
void RosGraph::publish(const std::vector<RosTransform>&) {}
void RosGraph::publish(const RosDiagnostics&) {}
GraphCounts RosGraph::counts() const { return {}; }
std::vector<std::string> RosGraph::take_mismatches() { return {}; }

}  // namespace posemix::internal
