// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "posemix/io/rigid.hpp"

/// Messages of ROS 2 as plain values, as far as `posemix live` takes or publishes them.
namespace posemix::internal {

/// std_msgs/Header.
struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame = {};
};

/// vision_msgs/ObjectHypothesisWithPose. The covariance is row by row, translation first, along
/// the axes of the header's frame.
struct RosResult {
  std::string class_id = {};
  double score = 0.0;
  PoseNumbers pose = {};
  std::array<double, 36> covariance = {};
};

/// vision_msgs/Detection3D, or Detection2D, whose box has no pose.
struct RosDetection {
  RosHeader header = {};
  std::vector<RosResult> results = {};
  PoseNumbers box = {};
  std::string id = {};
};

/// vision_msgs/Detection3DArray, or Detection2DArray.
struct RosDetections {
  RosHeader header = {};
  std::vector<RosDetection> detections = {};
};

/// geometry_msgs/TransformStamped, and what is taken of nav_msgs/Odometry: T_frame_child.
struct RosTransform {
  RosHeader header = {};
  std::string child = {};
  PoseNumbers pose = {};
};

/// diagnostic_msgs/DiagnosticStatus.
struct RosStatus {
  int level = 0;
  std::string name = {};
  std::string message = {};
  std::vector<std::pair<std::string, std::string>> values = {};
};

/// diagnostic_msgs/DiagnosticArray.
struct RosDiagnostics {
  RosHeader header = {};
  std::vector<RosStatus> statuses = {};
};

/// The pose of a message. Its quaternion is normalised.
/// @throws InvalidInput when a number is not finite or the quaternion is zero
SE3d pose_of(const PoseNumbers& numbers);
PoseNumbers numbers_of(const SE3d& pose);

/// The name of a frame without the leading slash of ROS 1.
std::string frame_name(const std::string& frame);

}  // namespace posemix::internal
