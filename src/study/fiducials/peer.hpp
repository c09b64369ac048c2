// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "estimate.hpp"
#include "posemix/fiducial/fiducial_folder.hpp"

/// Other programs for SLAM on square tags, from the same input as the filter.
namespace posemix {

/// A program that the shell runs with two arguments more, the folder of its input and one for its
/// result.
struct FiducialPeer {
  std::string name;     ///< in the tables
  std::string command;  ///< without the two folders
};

/// Runs a peer on a folder as write_fiducial_folder writes it.
///
/// The folder of the result needs camera.tum (T_world_rig) and sightings.csv
/// (stamp_s,camera,id,tx_m,ty_m,tz_m,qx,qy,qz,qw: T_camera_tag of the tags of a frame, as the
/// estimate stood after it); it may have tags.csv (id,tx_m,...: T_world_tag at the end) and
/// times.csv (frames,processor_s,worst_s).
/// @throws InvalidInput with the last line of its output when the program fails, and as the readers
/// of the files
FiducialEstimate run_peer(const FiducialPeer& peer, const std::filesystem::path& input,
                          const std::filesystem::path& result);

/// Continues a path by odometry, the poses at all stamps T_odom_rig: where it has none at a stamp
/// after its first one, its last pose moves as the odometry does. Filters that step at sightings
/// alone are so compared over the whole time.
std::vector<StampedPose> continued(std::span<const StampedPose> path,
                                   std::span<const StampedPose> odometry);

}  // namespace posemix
