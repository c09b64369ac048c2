// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string>
#include <string_view>

#include "posemix/detector/detector_noise.hpp"
#include "posemix/detector/odometry_noise.hpp"

/// Noise models as text for sequence files, the counterpart of read_detector_noise.
namespace posemix {

/// The table `[noise.NAME]` of a sequence file with all digits, so that it is read back as the same
/// model. Diagonal covariances are written as standard deviations.
/// @throws InvalidInput for a name other than letters, digits, '_' and '-'
std::string format_noise_toml(std::string_view name, const DetectorNoise& noise);

/// The table `[motion]` of a sequence file, with comments.
std::string format_odometry_toml(const OdometryNoise& noise);

}  // namespace posemix
