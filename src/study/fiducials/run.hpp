// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <nlohmann/json.hpp>

#include "posemix/slam/job.hpp"
#include "recording.hpp"
#include "study.hpp"

namespace posemix {

/// Puts the input in place of the observations.
void replace_observations(FiducialInput input, Sequence& sequence);

/// One recording with one input: {"row": {...}, "tags": [...], "timing": {...}, "path": {...}}.
/// @throws InvalidInput as the readers of the recording and of the sequence file
nlohmann::ordered_json run_fiducials(const FiducialRecording& recording, FiducialInput input,
                                     const FiducialsStudySettings& settings);

/// The same of a peer, whose input is what the filter reads: observations, cameras, odometry and,
/// where the filter knows the survey, the surveyed tags. There are no covariances to be scored.
/// @throws InvalidInput also as run_peer
nlohmann::ordered_json run_fiducials(const FiducialRecording& recording, const FiducialPeer& peer,
                                     const FiducialsStudySettings& settings);

}  // namespace posemix
