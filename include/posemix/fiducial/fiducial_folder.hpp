// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "posemix/base/units.hpp"
#include "posemix/fiducial/fiducials.hpp"
#include "posemix/io/tum.hpp"

namespace posemix {

/// Settings of the sequence file of a folder.
struct FiducialSequenceSettings {
  /// Least standard deviations of the known poses of tags: surveys are rarely as good as they say.
  double survey_rotation_sd = radians(1.0);  ///< [rad]
  double survey_position_sd = 0.01;          ///< [m]
};

/// All that a folder of fiducials holds.
struct FiducialFolder {
  Fiducials fiducials = {};
  std::vector<RigCamera> cameras = {};
  TagMap tags = {};
  std::vector<StampedPose> odometry = {};  ///< T_odom_rig; none: not written
  bool compress = false;                   ///< observations.csv.gz in place of observations.csv
  FiducialSequenceSettings sequence = {};
};

/// Gives cameras without a pose one from the tags that they share (calibrate_rig), and leaves out
/// the observations of those that share none. Returns their names.
std::vector<std::string> complete_rig(FiducialFolder& folder);

/// Odometry of the rig, T_odom_rig, by time, from that of the frame whose motion was recorded, at
/// `rig_odometry` (TagMap::rig_odometry) on the rig.
std::vector<StampedPose> odometry_of_rig(std::vector<StampedPose> odometry,
                                         const SE3d& rig_odometry);

/// Writes `sequence.toml`, `observations.csv`, `cameras.csv`, `corner_noise.csv`, and where there
/// is something to write `tag_priors.csv` and `odometry.tum`; the folder appears as a whole or not
/// at all.
/// @throws OutputError
void write_fiducial_folder(const FiducialFolder& folder, const std::filesystem::path& target);

}  // namespace posemix
