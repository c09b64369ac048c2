// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "posemix/fiducial/camera_file.hpp"
#include "posemix/slam/run.hpp"
#include "score.hpp"

namespace posemix {

/// A run on one recording, and what it is compared with.
struct FiducialRun {
  std::span<const Observation> observations;         ///< as the detector made them
  CameraPoses cameras;                               ///< T_rig_camera
  const std::map<std::int64_t, StatedPose>& survey;  ///< T_map_tag
  bool has_priors;  ///< the survey was known to the filter, whose world is then the map
  ReferencePath reference;
  const Sequence& sequence;  ///< that was run
  const SlamRun& run;
  std::vector<double> frame_s;  ///< processor time of every frame [s]
};

/// {"row": ..., "tags": ..., "timing": ..., "path": ...}; every row begins with `head`.
nlohmann::ordered_json fiducial_figures(const FiducialRun& run, nlohmann::ordered_json head);

}  // namespace posemix
