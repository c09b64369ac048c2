// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posemix/detector/observation.hpp"
#include "posemix/filter/moving_object_filter.hpp"
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
  /// Cameras whose images show none of the objects, next to those of observations and candidates:
  /// what is in view and not detected may be gone. CAMERA@DETECTOR: one detector searched it.
  std::vector<std::string> images = {};
  /// T_world_camera as it is given, for MotionModel::given; elsewhere it is not looked at.
  std::optional<SE3d> camera = {};
  /// T_world_frame of the frames that may hold objects, in the order of
  /// MultiObjectSlamSettings::frames, or none at all. One that is not given is where it was.
  std::vector<std::optional<KnownFrame>> frames = {};
};

}  // namespace posemix
