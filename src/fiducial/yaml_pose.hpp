// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/fiducial/camera_file.hpp"
#include "yaml_value.hpp"

namespace posemix::internal {

/// The pose of the keys `position` and `rotation`, a rotation vector [rad]. Its covariance is that
/// of `R` (camera_poses.yaml), or of `position_noise` and `rotation_noise` (tagslam.yaml).
StatedPose pose_of(const YamlValue& value);

}  // namespace posemix::internal
