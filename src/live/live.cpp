// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "live.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "node.hpp"
#include "ros_graph.hpp"

namespace posemix::internal {
namespace {

/// The program looks so often whether it shall stop [s].
constexpr double kLongestWait = 0.1;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::int64_t wall_nanoseconds() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since).count();
}

LivePorts ports_of(RosGraph& graph, const LiveOptions& options) {
  return {.now_s = steady_seconds,
          .clock_ns = wall_nanoseconds,
          .objects = [&graph](const RosDetections& message) { graph.publish(message); },
          .transforms = [&graph](const std::vector<RosTransform>& m) { graph.publish(m); },
          .diagnostics = [&graph](const RosDiagnostics& message) { graph.publish(message); },
          .log = options.log};
}

/// Motion before the images that may wait for it: the middleware has no order between topics.
void take_messages(RosGraph& graph, std::size_t sources, LiveNode& node) {
  for (const std::int64_t clock_ns : graph.take_clock()) node.take_clock(clock_ns);
  if (graph.take_reset()) node.reset();
  node.take_transforms(graph.take_transforms(true), true);
  node.take_transforms(graph.take_transforms(false), false);
  for (const RosTransform& message : graph.take_odometry()) node.take_odometry(message);
  for (std::size_t i = 0; i < sources; ++i) {
    for (const RosDetections& message : graph.take_detections(i)) node.take_detections(i, message);
  }
}

std::string topics_of(const LiveSettings& settings) {
  std::string topics;
  for (const LiveSource& source : settings.sources)
    topics += (topics.empty() ? "" : ", ") + topic_name(settings.node, source.topic);
  return topics;
}

}  // namespace

std::optional<LiveResult> run_live(const LiveSettings& settings, const LiveOptions& options) {
  RosGraph graph(settings);
  LiveNode node(settings, ports_of(graph, options), options.records);
  options.tell(fmt::format("domain {}: waits for {}, publishes {}", graph.domain(),
                           topics_of(settings), topic_name(settings.node, "~/objects")));
  const double period_s = 1.0 / settings.node.diagnostics_hz;
  const double patience_s = std::min(kLongestWait, 0.5 * settings.node.transform_timeout_s);
  double next_diagnostics_s = steady_seconds() + period_s;
  bool has_more = false;
  while (!options.stop()) {
    // With more to do it does not wait, but looks at what has come after every image.
    const double until_s = has_more ? 0.0 : next_diagnostics_s - steady_seconds();
    graph.wait(std::clamp(until_s, 0.0, patience_s));
    take_messages(graph, settings.sources.size(), node);
    has_more = node.work();
    if (steady_seconds() < next_diagnostics_s) continue;
    for (const std::string& mismatch : graph.take_mismatches()) node.complain(mismatch, true);
    node.diagnose(graph.counts());
    next_diagnostics_s = std::max(next_diagnostics_s + period_s, steady_seconds());
  }
  return node.engine().result();
}

}  // namespace posemix::internal
