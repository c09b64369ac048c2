// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <iterator>

#include "ros_wire.hpp"

namespace posemix::internal {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1000000000;

// A string of a message is never null, but one that was made by hand may be.
std::string plain_text(const char* text) { return text == nullptr ? "" : text; }

RosHeader plain_header(const std_msgs_msg_dds__Header_& header) {
  return {nanoseconds_of(header.stamp), plain_text(header.frame_id)};
}

PoseNumbers plain_pose(const geometry_msgs_msg_dds__Pose_& pose) {
  const auto& [p, q] = pose;
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

RosResult plain_result(const vision_msgs_msg_dds__ObjectHypothesisWithPose_& result) {
  RosResult found{.class_id = plain_text(result.hypothesis.class_id),
                  .score = result.hypothesis.score,
                  .pose = plain_pose(result.pose.pose)};
  std::copy(std::begin(result.pose.covariance), std::end(result.pose.covariance),
            found.covariance.begin());
  return found;
}

template <class Detection>
RosDetection plain_detection(const Detection& detection) {
  RosDetection found{.header = plain_header(detection.header), .id = plain_text(detection.id)};
  for (std::uint32_t i = 0; i < detection.results._length; ++i)
    found.results.push_back(plain_result(detection.results._buffer[i]));
  return found;
}

}  // namespace

std::int64_t nanoseconds_of(const builtin_interfaces_msg_dds__Time_& time) {
  return kNanosecondsPerSecond * time.sec + time.nanosec;
}

RosDetections plain(const vision_msgs_msg_dds__Detection3DArray_& message) {
  RosDetections found{.header = plain_header(message.header)};
  for (std::uint32_t i = 0; i < message.detections._length; ++i) {
    found.detections.push_back(plain_detection(message.detections._buffer[i]));
    found.detections.back().box = plain_pose(message.detections._buffer[i].bbox.center);
  }
  return found;
}

RosDetections plain(const vision_msgs_msg_dds__Detection2DArray_& message) {
  RosDetections found{.header = plain_header(message.header)};
  for (std::uint32_t i = 0; i < message.detections._length; ++i)
    found.detections.push_back(plain_detection(message.detections._buffer[i]));
  return found;
}

RosTransform plain(const geometry_msgs_msg_dds__TransformStamped_& message) {
  const auto& [t, q] = message.transform;
  return {plain_header(message.header),
          plain_text(message.child_frame_id),
          {t.x, t.y, t.z, q.x, q.y, q.z, q.w}};
}

RosTransform plain(const nav_msgs_msg_dds__Odometry_& message) {
  return {plain_header(message.header), plain_text(message.child_frame_id),
          plain_pose(message.pose.pose)};
}

}  // namespace posemix::internal
