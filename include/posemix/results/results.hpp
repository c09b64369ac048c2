// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "posemix/io/posterior_file.hpp"
#include "posemix/slam/evaluation.hpp"
#include "posemix/slam/job.hpp"

/// The files that `posemix slam` writes. docs/formats.md describes them.
namespace posemix {

/// Versions of metrics.json and trace.json that this library writes.
inline constexpr std::int64_t kMetricsSchema = 1;
inline constexpr std::int64_t kTraceSchema = 1;

/// Name and content of one file.
using NamedText = std::pair<std::string, std::string>;

/// All files of one run: camera.tum, object_<id>.tum, relative_<id>.tum, metrics.json,
/// posterior.json, trace.json and picture.svg, and for a rig with a camera that is calibrated
/// cameras.csv.
/// @throws InvalidInput when an estimate is not finite, which extreme numbers in the input can
/// cause
std::vector<NamedText> format_results(const SlamJob& job, const SlamRun& run,
                                      const Metrics& metrics);

/// metrics.json: root mean square errors, consistency and timing; null without ground truth.
std::string format_metrics(const Metrics& metrics, const std::string& method);

/// trace.json: estimates, detections and hypotheses frame by frame, for a report.
std::string format_trace(const SlamJob& job, const SlamRun& run);

/// posterior.json: the posterior of the last frame with the names of its poses.
PosteriorFile last_posterior(const SlamJob& job, const SlamRun& run);

}  // namespace posemix
