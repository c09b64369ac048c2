// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "posemix/config/data_folder.hpp"
#include "posemix/config/toml_table.hpp"
#include "posemix/slam/particle_filter.hpp"
#include "posemix/slam/smoothing.hpp"

/// Sequence files: a TOML document that names the files of a recording and how to filter it.
/// docs/formats.md lists every key.
namespace posemix {

/// Version of the sequence file that this library reads (key `schema`).
inline constexpr std::int64_t kSequenceSchema = 1;

/// Error of the camera's start pose where the file does not say (key `camera.start`): 0.05 deg, 2
/// mm.
inline constexpr double kStartRotationSdDeg = 0.05;
inline constexpr double kStartTranslationSdM = 2e-3;

/// Time between two frames where no file has stamps (key `camera.frame_period_s`).
inline constexpr double kFramePeriodS = 0.1;

/// Hypotheses per frame in trace.json where the file does not say (key `output.trace_hypotheses`).
inline constexpr std::size_t kTraceHypotheses = 12;

/// Frames that smoothing looks ahead where the file does not say (key `filter.smooth_lag`).
inline constexpr std::size_t kSmoothLag = 20;

/// All that object SLAM needs for one run.
struct SlamJob {
  std::string name;    ///< of sequence file and recording, for people
  std::string method;  ///< for people: "gm-iekf (midway)", "riekf", "rbpf (300 particles)"
  Sequence sequence;
  PoseDensity camera_prior;         ///< T_world_camera of the image frame, first frame
  std::vector<ObjectModel> models;  ///< one per object of the sequence
  ObjectSlamSettings settings;
  std::optional<ParticleFilterSettings> particles = {};  ///< filtered by particles in place of that
  std::optional<SmoothingSettings> smoothing = {};       ///< of the multi-object filter
  std::size_t trace_hypotheses = kTraceHypotheses;
};

/// Reads a sequence document and every file that it names.
///
/// A relative path is looked up as <folder>/<root>/<path> for every folder and every entry of the
/// key `roots`. The lever arm is applied on the right of the camera's ground truth and to nothing
/// else: T_world_image = T_world_annotated Trans(lever arm).
/// @throws InvalidInput naming file, line and key for anything that is missing, unknown, of another
/// type or out of range, and naming the file for contents that are not valid or do not fit the
/// other files
SlamJob read_slam_job(const TomlDocument& document,
                      const std::vector<std::filesystem::path>& folders);

/// Runs the job by the filter that it names: `run`, `run_smoothed` where it has smoothing, or
/// `run_particle_filter` where it has particles.
SlamRun run(const SlamJob& job, const RunOptions& options = {});

}  // namespace posemix
