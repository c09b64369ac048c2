// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <algorithm>
#include <string>

#include "ros_wire.hpp"

/// Messages that are written borrow their strings and arrays: they live until the middleware has
/// written them, and it changes nothing.
namespace posemix::internal {
namespace {

char* borrowed(const std::string& text) { return const_cast<char*>(text.c_str()); }

/// Points a sequence of a message to elements.
template <class Sequence, class Element>
void borrow(std::vector<Element>& elements, Sequence& sequence) {
  const auto count = static_cast<std::uint32_t>(elements.size());
  sequence = {._maximum = count, ._length = count, ._buffer = elements.data(), ._release = false};
}

std_msgs_msg_dds__Header_ wire_header(const RosHeader& header) {
  constexpr std::int64_t kSecond = 1000000000;
  // The fraction is not negative, before 1970 either.
  const std::int64_t fraction = (header.stamp_ns % kSecond + kSecond) % kSecond;
  return {.stamp = {.sec = static_cast<std::int32_t>((header.stamp_ns - fraction) / kSecond),
                    .nanosec = static_cast<std::uint32_t>(fraction)},
          .frame_id = borrowed(header.frame)};
}

geometry_msgs_msg_dds__Pose_ wire_pose(const PoseNumbers& n) {
  return {.position = {n[0], n[1], n[2]}, .orientation = {n[3], n[4], n[5], n[6]}};
}

vision_msgs_msg_dds__ObjectHypothesisWithPose_ wire_result(const RosResult& result) {
  vision_msgs_msg_dds__ObjectHypothesisWithPose_ wire{};
  wire.hypothesis = {.class_id = borrowed(result.class_id), .score = result.score};
  wire.pose.pose = wire_pose(result.pose);
  std::ranges::copy(result.covariance, wire.pose.covariance);
  return wire;
}

}  // namespace

dds_return_t write_message(dds_entity_t writer, const RosDetections& message) {
  std::vector<std::vector<vision_msgs_msg_dds__ObjectHypothesisWithPose_>> results;
  std::vector<vision_msgs_msg_dds__Detection3D_> detections;
  results.reserve(message.detections.size());
  for (const RosDetection& detection : message.detections) {
    auto& own = results.emplace_back();
    for (const RosResult& result : detection.results) own.push_back(wire_result(result));
    auto& wire = detections.emplace_back();
    wire.header = wire_header(detection.header);
    wire.bbox.center = wire_pose(detection.box);
    wire.id = borrowed(detection.id);
    borrow(own, wire.results);
  }
  vision_msgs_msg_dds__Detection3DArray_ wire{};
  wire.header = wire_header(message.header);
  borrow(detections, wire.detections);
  return dds_write(writer, &wire);
}

dds_return_t write_message(dds_entity_t writer, const std::vector<RosTransform>& message) {
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms;
  for (const RosTransform& transform : message) {
    auto& wire = transforms.emplace_back();
    wire.header = wire_header(transform.header);
    wire.child_frame_id = borrowed(transform.child);
    const PoseNumbers& n = transform.pose;
    wire.transform = {.translation = {n[0], n[1], n[2]}, .rotation = {n[3], n[4], n[5], n[6]}};
  }
  tf2_msgs_msg_dds__TFMessage_ wire{};
  borrow(transforms, wire.transforms);
  return dds_write(writer, &wire);
}

dds_return_t write_message(dds_entity_t writer, const RosDiagnostics& message) {
  const std::string no_hardware;
  std::vector<std::vector<diagnostic_msgs_msg_dds__KeyValue_>> values;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> statuses;
  values.reserve(message.statuses.size());
  for (const RosStatus& status : message.statuses) {
    auto& own = values.emplace_back();
    for (const auto& [key, value] : status.values)
      own.push_back({.key = borrowed(key), .value = borrowed(value)});
    auto& wire = statuses.emplace_back();
    wire.level = static_cast<std::uint8_t>(status.level);
    wire.name = borrowed(status.name);
    wire.message = borrowed(status.message);
    wire.hardware_id = borrowed(no_hardware);
    borrow(own, wire.values);
  }
  diagnostic_msgs_msg_dds__DiagnosticArray_ wire{};
  wire.header = wire_header(message.header);
  borrow(statuses, wire.status);
  return dds_write(writer, &wire);
}

}  // namespace posemix::internal
