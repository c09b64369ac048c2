// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <array>

#include <Eigen/Core>

#include "posemix/lie/lie.hpp"

namespace posemix::internal {

/// The two poses whose weak perspective image comes nearest to the corners, from which the minima
/// of the reprojection error are sought: they differ by the sign of the depths (Necker reversal;
/// oberkampf1996coplanar).
/// @param image normalised image coordinates of the corners, in the order of AprilTag; the camera
/// looks at about the centre of the tag
std::array<SE3d, 2> tag_starts(const std::array<Eigen::Vector2d, 4>& image, double size);

}  // namespace posemix::internal
