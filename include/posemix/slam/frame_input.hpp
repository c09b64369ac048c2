// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <vector>

#include "posemix/lie/lie.hpp"
#include "posemix/slam/candidate.hpp"

namespace posemix {

/// Input of one frame. Of the first frame of all `dt` and `motion` are ignored.
struct FrameInput {
  double dt = 0.0;                  ///< seconds since the last frame, positive
  std::optional<SE3d> motion = {};  ///< T_camera(k-1)_camera(k), from odometry
  std::vector<std::optional<SE3d>> detections =
      {};  ///< T_camera_object, one entry per object model
  /// Detections that name a class, for the multi-object tracker; each is of one instance at most.
  std::vector<Candidate> candidates = {};
};

}  // namespace posemix
