// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "posemix/detector/observation.hpp"
#include "posemix/fiducial/camera_file.hpp"

namespace posemix {

/// Gives cameras whose pose on the rig is not stated one, from the tags that they see at the same
/// time as a camera whose pose is known; those then serve for others. Every pair of sightings of
/// one tag at one stamp states T_rig_camera by each pair of its components. The pose that most
/// pairs support is taken, and the median of those pairs about it; the covariance is that of a
/// single pair about it, since their errors depend on each other.
///
/// Where no pose is stated at all, the frame of the first camera is that of the rig.
/// @param observations the cameras' names in Observation::camera; their order does not matter
/// @returns names of the cameras that share no tag with a known one, whose pose stays unknown
/// @throws InvalidInput for an observation of a camera that is not among `cameras`
std::vector<std::string> calibrate_rig(std::span<const Observation> observations,
                                       std::vector<RigCamera>& cameras);

}  // namespace posemix
