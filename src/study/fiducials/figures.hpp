// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include <nlohmann/json.hpp>

#include "estimate.hpp"
#include "posemix/fiducial/camera_file.hpp"

namespace posemix {

/// A run of the filter, whose estimates have covariances.
struct FiducialFilterRun {
  const Sequence& sequence;
  const SlamRun& run;
};

/// An estimate from one recording, and what it is compared with.
struct FiducialRun {
  std::span<const Observation> observations;         ///< as the detector made them
  CameraPoses cameras;                               ///< T_rig_camera
  const std::map<std::int64_t, StatedPose>& survey;  ///< T_map_tag
  bool has_priors;  ///< the survey was known to the filter, whose world is then the map
  ReferencePath reference;
  std::span<const double> stamps;         ///< of the frames [s]
  std::span<const StampedPose> odometry;  ///< T_odom_rig at the stamps; empty without one
  const FiducialEstimate& estimate;
  std::optional<FiducialFilterRun> filter;  ///< nothing for peers, which have no covariances here
};

/// {"row": ..., "tags": ..., "timing": ..., "path": ...}; every row begins with `head`.
nlohmann::ordered_json fiducial_figures(const FiducialRun& run, nlohmann::ordered_json head);

}  // namespace posemix
