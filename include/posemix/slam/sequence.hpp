// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posemix/filter/moving_object_filter.hpp"
#include "posemix/lie/lie.hpp"
#include "posemix/slam/candidate.hpp"

/// A recording as plain data. Every vector over frames has one entry per stamp.
namespace posemix {

/// The recording of one object. Poses are T_camera_object (or T_world_object where said), metres.
struct ObjectRecording {
  std::string id;  ///< names the output files
  std::vector<std::optional<SE3d>>
      detections;  ///< T_camera_object by the detector; empty: not detected
  std::vector<std::optional<SE3d>>
      relative_truth;                            ///< true T_camera_object; no entries where unknown
  std::vector<std::optional<SE3d>> world_truth;  ///< true T_world_object; no entries where unknown
};

/// The recording of a frame with a known pose, which may hold objects.
struct FrameRecording {
  std::string name;
  std::vector<std::optional<KnownFrame>> poses;  ///< T_world_frame; empty: it is where it was
};

/// A recording: stamps, and what is known at each.
struct Sequence {
  std::vector<double> stamps;                 ///< seconds, strictly increasing
  std::vector<std::optional<SE3d>> odometry;  ///< T_odom_camera; no entries: no odometry at all.
                                              ///< Under MotionModel::given T_world_camera
  std::vector<std::optional<SE3d>> camera_truth;  ///< true T_world_camera; no entries where unknown
  std::vector<ObjectRecording> objects;
  /// Detections that do not say which instance they are of; no entries: there are none.
  std::vector<std::vector<Candidate>> candidates = {};
  /// Detections that are mixtures, by frame; no entries: there are none. Trackers that take them
  /// use them in place of the detections of all objects, which are then their best components (from
  /// the body, where cameras have poses on it) and are what metrics and pictures compare with.
  std::vector<std::vector<Observation>> observations = {};
  /// By frame, names of cameras whose images the detectors have searched, also where they found
  /// nothing ("": the only camera): what is in view and was not detected may be gone. No entries:
  /// which images there are is not known, but for those with detections.
  std::vector<std::vector<std::string>> images = {};
  /// Frames that may hold objects, in the order of MultiObjectSlamSettings::frames.
  std::vector<FrameRecording> known_frames = {};
};

/// @throws InvalidInput when there is no frame, stamps do not increase, a vector has the wrong
/// length, or two objects share an id, or an observation is not valid
void validate(const Sequence& sequence);

}  // namespace posemix
