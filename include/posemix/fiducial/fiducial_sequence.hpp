// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "posemix/fiducial/fiducial_folder.hpp"

namespace posemix {

/// The sequence file of a folder of fiducials (docs/formats.md): its observations, the cameras that
/// have a pose, with their covariances, the odometry, the tags that were seen and whose pose is
/// known as objects with a prior, and all others on sight.
///
/// Where poses of tags are known the first pose of the rig is unknown, and found from them. With
/// odometry its noise is that of fit_tag_odometry, or a usual one where sightings are too few;
/// without, the rig moves at random.
std::string format_fiducial_sequence(const FiducialFolder& folder);

}  // namespace posemix
