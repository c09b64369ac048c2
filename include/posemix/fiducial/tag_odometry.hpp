// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "posemix/detector/observation.hpp"
#include "posemix/fiducial/camera_file.hpp"
#include "posemix/io/tum.hpp"

namespace posemix {

/// The noise of odometry as a random walk, right perturbation.
struct TagOdometryNoise {
  double rotation_sd = 0.0;     ///< about each axis [rad / sqrt(s)]
  double translation_sd = 0.0;  ///< along each axis [m / sqrt(s)]
  std::size_t pairs = 0;        ///< of sightings that it is from
};

/// Motion of the rig over one to five seconds by odometry against that by a tag which one camera
/// saw at both ends, without ambiguity. The difference has the covariance of the two sightings plus
/// time times that of the walk; it is taken for Student's t with four degrees of freedom, for
/// odometry jumps, whose scale follows by expectation maximisation. The result are standard
/// deviations.
/// @param odometry T_odom_rig, by time
/// @returns none for fewer than 20 pairs
std::optional<TagOdometryNoise> fit_tag_odometry(std::span<const Observation> observations,
                                                 std::span<const RigCamera> cameras,
                                                 std::span<const StampedPose> odometry);

}  // namespace posemix
