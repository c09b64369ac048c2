// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "ros_domain.hpp"

#include <cstdlib>

#include <fmt/format.h>

#include "posemix/base/error.hpp"
#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

/// Domains beyond have no ports.
constexpr std::int64_t kLastDomain = 232;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::uint32_t ros_domain() {
  const std::string text = environment("ROS_DOMAIN_ID");
  if (text.empty()) return 0;
  const auto number = parse_integer(text);
  if (number && *number >= 0 && *number <= kLastDomain) return static_cast<std::uint32_t>(*number);
  throw InvalidInput(fmt::format("ROS_DOMAIN_ID is {}, expected a number from 0 to {}",
                                 in_quotes(text), kLastDomain));
}

std::string loopback_configuration() {
  const bool local = environment("ROS_LOCALHOST_ONLY") == "1" ||
                     environment("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST";
  if (!local || !environment("CYCLONEDDS_URI").empty()) return "";
  return "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
         "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
         "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32"
         "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>"
         "</Domain></CycloneDDS>";
}

}  // namespace posemix::internal
