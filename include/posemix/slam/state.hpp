// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "posemix/slam/object_slam.hpp"
#include "posemix/slam/stamped_slam.hpp"

/// The whole posterior of live object SLAM as bytes, and back (docs/state.md).
namespace posemix {

/// Version of the bytes; it grows whenever they change.
inline constexpr std::uint32_t kStateFormat = 6;

/// The state of a tracker, with its models and settings: what goes on from it has the same bits as
/// what was never stopped. The same state always has the same bytes; measured times
/// (FrameReport::seconds) are no part of it.
std::string state_bytes(const MultiObjectSlam& slam);
/// The same with all that may still be changed by late input: waiting observations, odometry, and
/// the states of the history.
std::string state_bytes(const StampedSlam& slam);
/// @throws InvalidInput for a tracker that is not MultiObjectSlam
std::string state_bytes(const ObjectSlam& slam);

/// What a state may be of.
using SlamState = std::variant<MultiObjectSlam, StampedSlam>;

/// @throws InvalidInput, which says what was expected, for bytes that are no state, cut off or
/// damaged, of another version of the format, or that hold what no state can
SlamState slam_of_state(std::string_view bytes);

/// What the head of a state says of it.
struct StateInfo {
  std::uint32_t format = 0;
  std::string version;  ///< of the library that wrote it
  bool is_stamped = false;
  std::uint64_t payload_bytes = 0;
};

/// @throws InvalidInput for bytes that do not begin with the head of a state of this format
StateInfo state_info(std::string_view bytes);

/// In which parts the configuration of two trackers differs, to the last bit: "object 'mug'",
/// "settings", "motion", "record_hypotheses". Objects that the first one met on the way are none.
/// For a state that is loaded where a program has settings of its own; those of the state hold.
std::vector<std::string> configuration_differences(const MultiObjectSlam& loaded,
                                                   const MultiObjectSlam& expected);
/// The same, and "stamped".
std::vector<std::string> configuration_differences(const StampedSlam& loaded,
                                                   const StampedSlam& expected);

}  // namespace posemix
