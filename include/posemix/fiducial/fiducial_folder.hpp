// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "posemix/fiducial/fiducials.hpp"
#include "posemix/io/tum.hpp"

namespace posemix {

/// All that a folder of fiducials holds.
struct FiducialFolder {
  Fiducials fiducials = {};
  std::vector<RigCamera> cameras = {};
  TagMap tags = {};
  std::vector<StampedPose> odometry = {};  ///< T_odom_body; none: not written
  bool compress = false;                   ///< observations.csv.gz in place of observations.csv
};

/// Writes `observations.csv`, `cameras.csv`, `corner_noise.csv`, and where there is something to
/// write `tag_priors.csv` and `odometry.tum`; the folder appears as a whole or not at all.
/// @throws OutputError
void write_fiducial_folder(const FiducialFolder& folder, const std::filesystem::path& target);

}  // namespace posemix
