// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "posemix/fiducial/fiducial_folder.hpp"
#include "score.hpp"

/// Recordings of square tags, a folder each.
namespace posemix {

/// A folder with corners.csv and cameras.yaml, and if they are there camera_poses.yaml,
/// tagslam.yaml, odometry.tum (of the frame that tagslam.yaml states on the rig) and
/// reference_rig.tum (T_map_rig). CSV and TUM files may be compressed, with .gz after their names.
struct FiducialRecording {
  std::string name;  ///< of the folder
  std::filesystem::path folder;
};

/// The recordings in the sub-folders of a folder, by name.
/// @throws InvalidInput when the folder is not there, cannot be read, or has none
std::vector<FiducialRecording> find_fiducial_recordings(const std::filesystem::path& folder);

/// All of a recording that SLAM needs, with the observations of its cameras.
///
/// Cameras whose pose is not stated get one by complete_rig; those that cannot are left out, with
/// what they saw.
/// @param size_m edge of the tags that tagslam.yaml does not name [m]
/// @throws InvalidInput as the readers of the files and observe_fiducials, and when no observation
/// is left
FiducialFolder read_fiducial_recording(const FiducialRecording& recording,
                                       std::optional<double> size_m = {});

/// The path of the rig; one without poses where the recording has none.
ReferencePath read_fiducial_reference(const FiducialRecording& recording);

}  // namespace posemix
