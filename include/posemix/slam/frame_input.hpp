// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posemix/detector/observation.hpp"
#include "posemix/lie/lie.hpp"
#include "posemix/slam/candidate.hpp"

namespace posemix {

/// Input of one frame. Of the first frame of all `dt` and `motion` are ignored. With several
/// cameras on one body the camera of `motion` is the body.
struct FrameInput {
  double dt = 0.0;                  ///< seconds since the last frame, positive
  std::optional<SE3d> motion = {};  ///< T_camera(k-1)_camera(k), from odometry
  /// T_camera_object, one entry per object model, or none at all.
  std::vector<std::optional<SE3d>> detections = {};
  /// Detections that name a class, for the multi-object tracker; each is of one instance at most.
  std::vector<Candidate> candidates = {};
  /// Detections that are mixtures, for the multi-object tracker: of an object model, or of a class.
  /// Their stamps are not looked at.
  std::vector<Observation> observations = {};
  /// Names of cameras whose images show none of the objects, next to those of observations and
  /// candidates: what is in view and is not detected may be gone.
  std::vector<std::string> images = {};
};

}  // namespace posemix
