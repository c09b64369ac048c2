// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/detector/detector_noise.hpp"

namespace posemix {

/// The error of detectors of single images, where nothing better is known, in NoiseFrame::ray:
/// standard deviations of 7.5 deg about the axes across the viewing ray and 2 deg about the ray,
/// and of 0.7 % of the range across the ray and 4.5 % along it; a second component 2.7 times as
/// wide; and clutter. Errors along the ray have most in common, so that the update covariance along
/// it is 12 times the standard deviation. docs/many-objects.md has the origin of the numbers.
DetectorNoise default_detector_noise();

}  // namespace posemix
