// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>

#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/job.hpp"

namespace posemix {

/// picture.svg: a map of camera path and objects with their 3-sigma ellipses, seen along the world
/// axis in which the camera moved least, and below it for each object the error of
/// T_camera_object's rotation over time with its 3-sigma width (the width alone where there is no
/// ground truth).
/// @throws InvalidInput when the run or the metrics are not of the job
std::string format_picture(const SlamJob& job, const SlamRun& run, const Metrics& metrics);

}  // namespace posemix
