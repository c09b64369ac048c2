// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "posemix/slam/stamped_slam.hpp"

/// What a file for `posemix live` says. docs/live.md lists every key.
namespace posemix::internal {

/// Version of the file (key `schema`).
inline constexpr std::int64_t kLiveSchema = 1;

/// A detector, a table [[sources]].
struct LiveSource {
  std::string name = "detections";
  std::string detector = {};  ///< in observations: the name, but of the first "", which has none
  std::string topic = "~/detections";
  bool flat = false;       ///< Detection2DArray
  std::string frame = {};  ///< of the camera, in place of that in the messages
  bool of_box = false;     ///< poses are those of boxes
  double least_score = 0.0;
  bool reliable = false;  ///< in place of best effort
  DetectorNoise noise = default_detector_noise();
};

/// The table [live].
struct LiveNodeSettings {
  std::string name = "posemix";
  std::string world_frame = "map";
  std::string odom_frame = "odom";
  std::string odometry_topic = {};  ///< empty: the odometry is in /tf
  std::string camera_frame = {};    ///< empty: that of the first detections
  std::string body_frame = "base_link";
  std::vector<std::string> cameras = {};  ///< frames of a rig
  double max_gap_s = 0.2;
  double transform_timeout_s = 0.5;
  std::size_t queue_size = 100;
  std::size_t input_depth = 10;
  bool empty_is_image = true;
  bool use_sim_time = false;
  double least_existence = 0.5;
  bool publish_tf = true;
  bool publish_world_tf = true;
  std::string tf_prefix = {};
  double transform_time_offset_s = 0.0;
  double diagnostics_hz = 1.0;
};

/// All that `posemix live` does by.
struct LiveSettings {
  LiveNodeSettings node = {};
  std::vector<LiveSource> sources = {};
  std::vector<ObjectModel> models = {};
  MultiObjectSlamSettings tracker = {};
  MotionSettings motion = {};
  StampedSlamSettings stamped = {};
  std::string method = {};  ///< its title, for results
  /// T_world_body at the first image; its mean where `starts_at_odometry` is that of the odometry.
  PoseDensity start = PoseDensity(SE3d(), Matrix6d::Identity());
  bool starts_at_odometry = true;
  std::size_t trace_hypotheses = 0;
  std::size_t report_images = 0;  ///< so many of the last images are in the results at the end

  /// Whether the motion model takes poses of odometry.
  bool has_odometry() const;
};

/// Reads a file for `posemix live`.
/// @throws InvalidInput naming file, line and key for a key that is missing, unknown, of a wrong
/// type or out of range
LiveSettings read_live_settings(const TomlDocument& document,
                                const std::vector<std::filesystem::path>& folders);

/// A topic with `~` in place of the node's name.
std::string topic_name(const LiveNodeSettings& node, const std::string& topic);

}  // namespace posemix::internal
