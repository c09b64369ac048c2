// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "node.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

constexpr std::size_t kLatencies = 1000;

}  // namespace

LiveNode::LiveNode(const LiveSettings& settings, LivePorts ports, bool records)
    : settings_(&settings), ports_(std::move(ports)), engine_(settings, records) {}

void LiveNode::take_detections(std::size_t source, const RosDetections& message) {
  try {
    for (LiveImage& image :
         images_of(message, settings_->sources[source], ports_.now_s(), clock_ns()))
      engine_.add(std::move(image));
  } catch (const InvalidInput& error) {
    engine_.refuse_message();
    ++bad_;
    complain(error.what());
  }
}

void LiveNode::take_transforms(const std::vector<RosTransform>& message, bool is_static) {
  for (const RosTransform& item : message) {
    const std::string parent = frame_name(item.header.frame);
    const std::string child = frame_name(item.child);
    try {
      const auto stamp = is_static ? std::nullopt : std::optional(item.header.stamp_ns);
      engine_.around().frames().add(parent, child, stamp, pose_of(item.pose));
    } catch (const InvalidInput& error) {
      complain(fmt::format("the transform from {} to {}: {}", in_quotes(child), in_quotes(parent),
                           error.what()));
    }
  }
}

void LiveNode::take_odometry(const RosTransform& message) {
  try {
    engine_.around().add_odometry(message);
  } catch (const InvalidInput& error) {
    complain(error.what());
  }
}

std::int64_t LiveNode::clock_ns() const {
  return settings_->node.use_sim_time ? sim_clock_ns_ : ports_.clock_ns();
}

void LiveNode::take_clock(std::int64_t clock_ns) {
  const bool is_back = clock_ns < sim_clock_ns_;
  sim_clock_ns_ = clock_ns;
  if (!is_back) return;
  reset();
  complain("the clock has jumped back: all is forgotten");
}

void LiveNode::reset() {
  engine_.reset();
  publish_nothing();
}

/// The last message stays for those that subscribe later.
void LiveNode::publish_nothing() {
  last_.reset();
  in_tf_.reset();
  ports_.objects({.header = {clock_ns(), settings_->node.world_frame}, .detections = {}});
}

bool LiveNode::work() {
  if (engine_.waiting() == 0) return false;
  const std::size_t resets = engine_.counts().resets;
  const std::vector<LiveEstimate> estimates = engine_.ready(ports_.now_s(), 1);
  for (const LiveEstimate& estimate : estimates) publish(estimate);
  const LiveCounts& counts = engine_.counts();
  if (counts.resets > resets) {
    complain(engine_.why_reset());
    if (engine_.is_empty()) publish_nothing();
  }
  const std::size_t bad =
      counts.dropped + counts.refused + counts.without_odometry + counts.too_late;
  if (bad > bad_) complain(engine_.complaint());
  bad_ = bad;
  return !estimates.empty() && engine_.waiting() > 0;
}

void LiveNode::publish(const LiveEstimate& estimate) {
  ports_.objects(objects_message(estimate, settings_->node));
  latencies_.push_back(ports_.now_s() - estimate.arrival_s);
  if (latencies_.size() > kLatencies) latencies_.pop_front();
  last_ = estimate;
  if (!in_tf_ || in_tf_->stamp_ns != estimate.stamp_ns) in_tf_ = InTf{estimate.stamp_ns, {}};
  auto transforms = transforms_message(estimate, settings_->node, below_world(estimate));
  std::erase_if(transforms, [&](const RosTransform& transform) {
    return !in_tf_->frames.insert(transform.child).second;
  });
  if (!transforms.empty()) ports_.transforms(transforms);
}

/// With odometry it is the frame of the odometry that this node puts below the world, without it
/// the root of the tree in which the body is.
std::optional<FrameBelow> LiveNode::below_world(const LiveEstimate& estimate) {
  const LiveNodeSettings& node = settings_->node;
  if (!node.publish_world_tf) return std::nullopt;
  const std::string& body = engine_.around().body();
  const FrameTree& frames = engine_.around().frames();
  if (settings_->has_odometry()) {
    if (node.odom_frame == node.world_frame) return std::nullopt;
    const std::string above = frames.parent(node.odom_frame);
    if (above.empty()) {
      if (!estimate.odometry) return std::nullopt;
      return FrameBelow(node.odom_frame, *estimate.odometry);
    }
    complain(
        fmt::format("{} is below {} in /tf already, so that this node does not say where it "
                    "is in {} (publish_world_tf)",
                    in_quotes(node.odom_frame), in_quotes(above), in_quotes(node.world_frame)));
    return std::nullopt;
  }
  const std::string root = frames.root(body);
  if (root != node.world_frame) {
    const auto pose = frames.at(root, body, estimate.stamp_ns, node.max_gap_s);
    return pose ? std::optional(FrameBelow(root, *pose)) : std::nullopt;
  }
  complain(
      fmt::format("{0} is below {1} in /tf already, so that this node does not say where it is "
                  "in {1} (publish_world_tf)",
                  in_quotes(body), in_quotes(root)));
  return std::nullopt;
}

void LiveNode::diagnose(const GraphCounts& graph) {
  const LiveNodeSettings& node = settings_->node;
  RosDiagnostics message{.header = {clock_ns(), ""}};
  const auto problems = complaints_.recent(ports_.now_s(), 2.0 / node.diagnostics_hz);
  message.statuses.push_back(node_status(node.name, engine_.counts(), problems));
  auto& values = message.statuses.back().values;
  values.emplace_back("waiting", std::to_string(engine_.waiting()));
  values.emplace_back("sources", std::to_string(settings_->sources.size()));
  values.emplace_back("publishers", std::to_string(graph.publishers));
  values.emplace_back("unsent", std::to_string(graph.unsent));
  add_latencies(message.statuses.back());
  if (last_) {
    auto objects = object_statuses(*last_, node.name);
    std::ranges::move(objects, std::back_inserter(message.statuses));
  }
  ports_.diagnostics(message);
}

void LiveNode::add_latencies(RosStatus& status) const {
  if (latencies_.empty()) return;
  std::vector<double> ordered(latencies_.begin(), latencies_.end());
  std::ranges::sort(ordered);
  const auto quantile = [&](double share) {
    const auto place = static_cast<std::size_t>(share * static_cast<double>(ordered.size() - 1));
    return fmt::format("{:.3f}", 1e3 * ordered[place]);
  };
  status.values.emplace_back("latency_median_ms", quantile(0.5));
  status.values.emplace_back("latency_99_ms", quantile(0.99));
}

void LiveNode::complain(const std::string& why, bool lasts) {
  if (complaints_.add(why, ports_.now_s(), lasts)) ports_.log(why);
}

}  // namespace posemix::internal
