// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <optional>

#include "posemix/fiducial/tag_pose.hpp"

namespace posemix::internal {

/// The local minimum of the squared reprojection error that Levenberg and Marquardt's method
/// reaches from a pose; nothing when a corner leaves the image of the camera.
std::optional<TagMinimum> refined(const SE3d& start, const TagCorners& corners, double size,
                                  const CameraModel& camera);

}  // namespace posemix::internal
