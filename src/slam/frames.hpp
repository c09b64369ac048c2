// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/slam/run.hpp"

/// What the trackers have in common: frames in and out.
namespace posemix::internal {

/// @throws InvalidInput when the sequence is not valid or the models are not one for each object,
/// with its id and in the same order
void check_run(const Sequence& sequence, const std::vector<ObjectModel>& models);

/// The input of one frame; at the first one there is no time and no motion. Where the recording has
/// observations, they take the place of the detections for a tracker that takes them.
FrameInput frame_input(const Sequence& sequence, std::size_t frame, bool takes_observations);

/// @throws InvalidInput when the frame has candidates or observations, which the named filter does
/// not take
void require_plain_detections(const FrameInput& input, const char* filter);
/// One detection per object, also where the frame has none at all.
std::vector<std::optional<SE3d>> all_detections(const FrameInput& input, std::size_t objects);

/// The marginals of one frame; objects without an index are empty.
FrameEstimate frame_estimate(const Hypothesis& joint,
                             const std::vector<std::optional<std::size_t>>& pose_indices,
                             const ObjectIds& ids, FrameReport report);

std::vector<HypothesisSnapshot> snapshots(const Posterior& posterior);

}  // namespace posemix::internal
