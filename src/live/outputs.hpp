// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine.hpp"
#include "messages.hpp"
#include "settings.hpp"

/// Estimates as messages.
namespace posemix::internal {

/// The objects that exist: `id` is the object, `results` are its hypotheses with weights that sum
/// to one, the box is at the leading one.
RosDetections objects_message(const LiveEstimate& estimate, const LiveNodeSettings& node);

/// A frame below the world, and T_frame_body.
using FrameBelow = std::pair<std::string, SE3d>;

/// Confirmed objects in the world, and the frame below it.
std::vector<RosTransform> transforms_message(const LiveEstimate& estimate,
                                             const LiveNodeSettings& node,
                                             const std::optional<FrameBelow>& below);

/// One status per object that was seen: good is OK, lost and inconsistent are errors, others
/// warnings.
std::vector<RosStatus> object_statuses(const LiveEstimate& estimate, const std::string& node);

/// The status of the node: what became of the images, and what is wrong at the moment.
RosStatus node_status(const std::string& node, const LiveCounts& counts,
                      const std::vector<std::string>& problems);

/// The covariance of a message, row by row and translation first, of errors about and along the
/// axes of the parent frame at the object; `left` is that of the left perturbation.
std::array<double, 36> covariance_numbers(const SE3d& pose, const Matrix6d& left);

}  // namespace posemix::internal
