// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "posemix/config/data_folder.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/slam/job.hpp"

/// Sequence files: a TOML document that names the files of a recording and how to filter it.
/// docs/formats.md lists every key.
namespace posemix {

/// Version of the sequence file that this library reads (key `schema`).
inline constexpr std::int64_t kSequenceSchema = 1;

/// Standard deviations of the camera's start pose if the file does not have them (key
/// `camera.start`): 0.05 deg, 2 mm.
inline constexpr double kStartRotationSdDeg = 0.05;
inline constexpr double kStartTranslationSdM = 2e-3;

/// Time between two frames if no file has stamps (key `camera.frame_period_s`).
inline constexpr double kFramePeriodS = 0.1;

/// Reads a sequence document and every file that it names.
///
/// A relative path is looked up as <folder>/<root>/<path> for every folder and every entry of the
/// key `roots`. The lever arm is applied only to the camera's ground truth, on the right:
/// T_world_image = T_world_annotated Trans(lever arm).
/// @throws InvalidInput naming file, line and key for a key that is missing, unknown, of a wrong
/// type or out of range, and naming the file for contents that are not valid or do not fit the
/// other files
SlamJob read_slam_job(const TomlDocument& document,
                      const std::vector<std::filesystem::path>& folders);

}  // namespace posemix
