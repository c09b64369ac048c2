// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/base/units.hpp"
#include "posemix/detector/detector_noise.hpp"

namespace posemix {

/// The error of detectors of single images, where nothing better is known, in NoiseFrame::ray.
/// White are standard deviations of 3.2 deg about the axes across the viewing ray, 2.1 deg about
/// the ray, and of the range 0.36 % across the ray and 3.1 % along it; slow are 5.6 deg, 3 deg, 1.2
/// % and 5.2 %, with a correlation angle of 90 deg and no decay with time. Next to them there are
/// gross errors 2.7 times as wide as the white part, ten of which count as one, and clutter; a
/// detector stays with one mode for 30 s. docs/many-objects.md has the origin of the numbers.
DetectorNoise default_detector_noise();

/// The part of a variance, and the correlation angle [rad], of the slow error that is assumed for a
/// noise of which only its size is known.
inline constexpr double kAssumedSlowFraction = 0.75;
inline constexpr double kAssumedCorrelationAngle = radians(90.0);

/// A model without a slow error, of whose components a part is taken for slow: kAssumedSlowFraction
/// of the covariance of the first one, or less where another component would not stay positive
/// definite. The sum of both parts is the noise as given. A model with a slow error, or with
/// components in different frames, is returned as it is.
DetectorNoise with_assumed_slow_error(const DetectorNoise& noise);

}  // namespace posemix
