// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>

namespace posemix::internal {

/// The domain of ROS_DOMAIN_ID; 0 where it is not set.
/// @throws InvalidInput for what is no number in [0, 232]
std::uint32_t ros_domain();

/// The configuration of Cyclone DDS for the loopback device alone, where the environment wants that
/// and CYCLONEDDS_URI, which has the last word, is not set; else empty.
std::string loopback_configuration();

}  // namespace posemix::internal
