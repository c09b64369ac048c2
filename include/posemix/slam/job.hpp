// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posemix/slam/method.hpp"
#include "posemix/slam/run.hpp"

namespace posemix {

/// Hypotheses per frame in a trace where nothing else is said.
inline constexpr std::size_t kTraceHypotheses = 12;

/// All that object SLAM needs for one run.
struct SlamJob {
  std::string name;    ///< display name of the recording
  std::string method;  ///< display name of the method: "gm-iekf (midway)", "rbpf (300 particles)"
  Sequence sequence;
  PoseDensity camera_prior;         ///< T_world_camera of the image frame, first frame
  std::vector<ObjectModel> models;  ///< one per object of the sequence
  ObjectSlamSettings settings;
  std::optional<SmoothingSettings> smoothing = {};  ///< of the multi-object tracker
  std::size_t trace_hypotheses = kTraceHypotheses;

  /// Sets the job's method: its title, tracker, smoothing, and noise of the object models.
  /// @throws InvalidInput as SlamMethod::models
  void use(const SlamMethod& chosen);
};

/// Runs the job: `run`, or `run_smoothed` where it has smoothing.
/// @throws InvalidInput as these
SlamRun run(const SlamJob& job, const RunOptions& options = {});

}  // namespace posemix
