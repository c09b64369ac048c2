// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <vector>

#include <dds/dds.h>
#include <ros_messages.h>

#include "messages.hpp"

/// Messages in the form of the middleware, and back.
namespace posemix::internal {

RosDetections plain(const vision_msgs_msg_dds__Detection3DArray_& message);
RosDetections plain(const vision_msgs_msg_dds__Detection2DArray_& message);
RosTransform plain(const geometry_msgs_msg_dds__TransformStamped_& message);
RosTransform plain(const nav_msgs_msg_dds__Odometry_& message);
std::int64_t nanoseconds_of(const builtin_interfaces_msg_dds__Time_& time);

/// Writes a message.
/// @return the middleware's code
dds_return_t write_message(dds_entity_t writer, const RosDetections& message);
dds_return_t write_message(dds_entity_t writer, const std::vector<RosTransform>& message);
dds_return_t write_message(dds_entity_t writer, const RosDiagnostics& message);

}  // namespace posemix::internal
