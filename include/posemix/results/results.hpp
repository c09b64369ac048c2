// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posemix/io/output_folder.hpp"
#include "posemix/io/posterior_file.hpp"
#include "posemix/results/hypothesis_record.hpp"
#include "posemix/results/provenance.hpp"
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
/// cause, and when the run or the metrics are not of the job
std::vector<NamedText> format_results(const SlamJob& job, const SlamRun& run,
                                      const Metrics& metrics);

struct ResultOptions {
  std::optional<Provenance> provenance = {};  ///< for metrics.json
  /// The hypotheses of all frames, where they were taken out of the run.
  const HypothesisRecord* hypotheses = nullptr;
};

/// The same with more for metrics.json and trace.json.
/// @throws InvalidInput also when the record has another number of frames than the run
std::vector<NamedText> format_results(const SlamJob& job, const SlamRun& run,
                                      const Metrics& metrics, const ResultOptions& options);

/// Writes all of these files into a folder, with little memory beside the run's own, and names the
/// earlier results in it for removal: commit() is left to the caller. Returns metrics.json.
/// @throws InvalidInput as format_results, OutputError as OutputFolder
std::string write_results(OutputFolder& folder, const SlamJob& job, const SlamRun& run,
                          const Metrics& metrics, const ResultOptions& options = {});

/// The names of the files in a folder that belong to a run whose metrics.json is in it, a report
/// included; by the names of the run's objects, so that files of others are not among them.
std::vector<std::filesystem::path> earlier_results(const std::filesystem::path& folder);

/// The same for the study whose study.json is in the folder, by its key `files`, and for what
/// posemix consistency wrote.
std::vector<std::filesystem::path> earlier_study(const std::filesystem::path& folder);
std::vector<std::filesystem::path> earlier_consistency(const std::filesystem::path& folder);

/// metrics.json: root mean square errors, consistency and timing; null without ground truth.
std::string format_metrics(const Metrics& metrics, const std::string& method);

/// trace.json: estimates, detections and hypotheses frame by frame, for a report.
/// @throws InvalidInput when the run is not of the job
std::string format_trace(const SlamJob& job, const SlamRun& run);

/// posterior.json: the posterior of the last frame with the names of its poses.
/// @throws InvalidInput when the run is not of the job
PosteriorFile last_posterior(const SlamJob& job, const SlamRun& run);

}  // namespace posemix
