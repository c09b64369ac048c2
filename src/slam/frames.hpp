// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posemix/slam/run.hpp"

/// What the filters of the room `slam` have in common: frames in and out. In this room only.
namespace posemix::internal {

/// @throws InvalidInput when the sequence is not valid or the models are not one for each object
void check_run(const Sequence& sequence, const std::vector<ObjectModel>& models);

/// The input of one frame; at the first one there is no time and no odometry.
FrameInput frame_input(const Sequence& sequence, std::size_t frame);

/// The camera alone, with its motion (at rest) where the model needs one.
Hypothesis camera_hypothesis(const PoseDensity& camera, const MotionSettings& motion);

/// The camera moved by one frame.
Hypothesis moved(Hypothesis hypothesis, const MotionSettings& motion, const FrameInput& input);

/// The marginals of one frame; objects without an index are empty.
FrameEstimate frame_estimate(const Hypothesis& joint,
                             const std::vector<std::optional<std::size_t>>& pose_indices,
                             FrameReport report);

std::vector<HypothesisSnapshot> snapshots(const Posterior& posterior);

}  // namespace posemix::internal
