// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "score.hpp"

namespace posemix {

/// The processor's time for the frames of a recording.
struct FiducialTimes {
  std::size_t frames = 0;
  double processor_s = 0.0;  ///< of all frames
  double worst_s = 0.0;      ///< of one
};

/// What is estimated from a recording of tags, by the filter or by a peer.
struct FiducialEstimate {
  std::vector<StampedPose> camera = {};     ///< T_world_rig, by increasing stamps
  std::vector<TagSighting> sightings = {};  ///< as the estimate stood after their frame
  std::map<std::string, SE3d> tags = {};    ///< T_world_tag at the end
  std::optional<FiducialTimes> times = {};
};

/// That of a run of the filter, without times. Frames without a finite pose are left out.
FiducialEstimate estimate_of(const Sequence& sequence, const SlamRun& run,
                             const CameraPoses& cameras);

}  // namespace posemix
