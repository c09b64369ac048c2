// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "detections.hpp"
#include "posemix/slam/rig.hpp"
#include "settings.hpp"
#include "transforms.hpp"

/// What is around a camera at a time: the frames of detections, the rig, odometry.
namespace posemix::internal {

/// An image with what its stamp needs.
struct ReadyImage {
  LiveImage image;                    ///< its poses are in the frame of the camera
  std::optional<SE3d> odometry = {};  ///< T_odom_body
};

/// Transforms and odometry over a window of time.
class Surroundings {
 public:
  explicit Surroundings(const LiveSettings& settings);

  /// Takes T_odom_child of nav_msgs/Odometry.
  /// @throws InvalidInput for another frame than `odom_frame`, and a pose that is none
  void add_odometry(const RosTransform& message);
  /// Takes the body from the first image.
  void see(const LiveImage& image);
  /// The image with its poses in the frame of its camera, and with odometry; none where that is not
  /// known. Where the time for waiting `is_over`, it may be without odometry.
  std::optional<ReadyImage> ready(const LiveImage& image, bool is_over);
  /// Forgets all but transforms for all times.
  void clear();

  /// Frame of the body: that of the rig, or of the one camera; empty before the first image.
  const std::string& body() const { return body_; }
  /// The cameras of the rig, as /tf_static has them.
  const std::vector<BodyCamera>& cameras() const { return cameras_; }
  /// Why an image waits or is left out.
  const std::string& complaint() const { return complaint_; }
  FrameTree& frames() { return frames_; }
  const FrameTree& frames() const { return frames_; }

 private:
  bool move_to_camera(LiveImage& image);
  bool find_cameras();
  std::optional<SE3d> odometry_at(std::int64_t stamp_ns) const;

  const LiveSettings* settings_;
  FrameTree frames_;
  PoseLine odometry_;
  std::string base_;  ///< child of the odometry
  std::string body_;
  std::vector<BodyCamera> cameras_;
  std::string complaint_;
};

}  // namespace posemix::internal
