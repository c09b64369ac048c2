// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "live/node.hpp"
#include "posemix/config/toml_table.hpp"

/// A robot with a camera and a detector, and the node that hears it, without a middleware.
namespace posemix::testing {

using namespace internal;

inline constexpr std::int64_t kStartNs = 1700000000 * std::int64_t{1000000000};

inline std::int64_t at_ns(double seconds) { return kStartNs + nanoseconds(seconds); }

inline LiveSettings live_settings(const std::string& text) {
  return read_live_settings(TomlDocument::parse("schema = 1\n" + text, "live.toml"), {"."});
}

inline SE3d mug_pose() { return SE3d(SO3d::exp({0.1, 0.2, 0.3}), {0.1, 0.0, 0.8}); }
inline SE3d box_pose() { return SE3d(SO3d::exp({0.0, 0.0, 1.0}), {-0.2, 0.1, 1.0}); }

/// T_odom_camera of a camera that goes by.
inline SE3d camera_at(double seconds) {
  Vector6d twist;
  twist << 0.0, 0.05, 0.0, 0.1, 0.0, 0.0;
  return SE3d::exp(seconds * twist);
}

inline RosResult result(const std::string& name, const SE3d& pose, double score = 0.9) {
  return {.class_id = name, .score = score, .pose = numbers_of(pose)};
}

/// An array with one detection of each of these poses, as they are from the camera.
inline RosDetections array_at(double seconds, const std::map<std::string, SE3d>& seen,
                              const std::string& frame = "camera") {
  RosDetections message{.header = {at_ns(seconds), frame}};
  for (const auto& [name, pose] : seen)
    message.detections.push_back({.header = message.header, .results = {result(name, pose)}});
  return message;
}

/// What a node says, by a clock that the test moves.
struct LiveBench {
  explicit LiveBench(const std::string& text, bool records = false)
      : settings(live_settings(text)), node(settings, ports(), records) {}

  LivePorts ports() {
    return {.now_s = [this] { return now_s; },
            .clock_ns = [this] { return at_ns(now_s); },
            .objects = [this](const RosDetections& m) { objects.push_back(m); },
            .transforms = [this](const std::vector<RosTransform>& m) { transforms = m; },
            .diagnostics = [this](const RosDiagnostics& m) { diagnostics = m; },
            .log = [this](const std::string& line) { log.push_back(line); }};
  }

  void move(double seconds) {
    node.take_transforms({{{at_ns(seconds), "odom"}, "camera", numbers_of(camera_at(seconds))}},
                         false);
  }
  /// What a camera that goes by sees of mug and box, with errors of some millimetres.
  void see(double seconds) {
    const SE3d back = camera_at(seconds).inverse();
    Vector6d error;
    for (Eigen::Index i = 0; i < 6; ++i)
      error[i] = 0.003 * std::sin(17.0 * seconds + static_cast<double>(i));
    detect(array_at(seconds, {{"mug", back * mug_pose() * SE3d::exp(error)},
                              {"box", back * box_pose() * SE3d::exp(-error)}}));
  }
  void detect(const RosDetections& message, std::size_t source = 0) {
    node.take_detections(source, message);
    while (node.work()) continue;
  }
  const LiveCounts& counts() const { return node.engine().counts(); }
  /// The value of a key of the node's status.
  std::string status(const std::string& key) {
    node.diagnose();
    for (const auto& [name, value] : diagnostics.statuses.front().values)
      if (name == key) return value;
    return "";
  }

  double now_s = 100.0;
  std::vector<RosDetections> objects = {};
  std::vector<RosTransform> transforms = {};
  RosDiagnostics diagnostics = {};
  std::vector<std::string> log = {};
  LiveSettings settings;
  LiveNode node;
};

}  // namespace posemix::testing
