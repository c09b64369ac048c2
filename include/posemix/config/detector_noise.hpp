// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include "posemix/config/toml_table.hpp"
#include "posemix/detector/detector_noise.hpp"

namespace posemix {

/// Reads the noise of a detector from a table with the key `components`, such as `[noise.NAME]` of
/// a sequence file (docs/formats.md).
/// @throws InvalidInput naming file, line and key
DetectorNoise read_detector_noise(const TomlTable& model);

/// Reads a diagonal covariance from the keys rotation_sd_deg and translation_sd_m, which must both
/// exist and be positive.
/// @throws InvalidInput naming file, line and key
Matrix6d read_pose_covariance(const TomlTable& table);

}  // namespace posemix
