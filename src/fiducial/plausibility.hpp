// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <span>
#include <string>
#include <vector>

#include "posemix/fiducial/fiducials.hpp"

namespace posemix::internal {

/// What is known of the corners in the images of one camera.
struct CornersOfCamera {
  const RigCamera& camera;
  const CameraCornerNoise& noise;
  std::span<const std::vector<TagMinimum>> minima;  ///< of every sighting with a pose
  std::span<const TagCorners> corners;              ///< of the same sightings [px]
};

/// What is hardly true of the corners of a camera, and what may be wrong; one sentence each.
std::vector<std::string> doubts_about_corners(const CornersOfCamera& seen);

/// The same of the sizes of the tags that were seen [m].
std::vector<std::string> doubts_about_sizes(std::span<const double> sizes_m);

/// The same of the number of sightings whose corners are no image of a tag's front.
std::vector<std::string> doubts_about_order(const Fiducials& found);

}  // namespace posemix::internal
