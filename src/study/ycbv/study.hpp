// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "posemix/config/toml_table.hpp"
#include "study/engine/study.hpp"

/// Object SLAM on recordings (midway-merge paper, Section VII-B, Tables II and III).
namespace posemix {

/// Settings of `study ycbv`: the recordings and the methods to compare.
struct YcbvStudySettings {
  std::filesystem::path data = {};  ///< the folder of the recordings, see find_recordings
  /// Names of ycbv_methods, or "NAME: KEY=VALUE ...": the default filter with overrides.
  std::vector<std::string> methods = {};
  std::vector<std::string> sequences = {};  ///< such as "0022"; empty: all
  std::vector<std::string> objects = {};    ///< such as "003_cracker_box_16k", or "all"; empty: all
  std::vector<std::string> overrides =
      {};  ///< for every method, as for TomlDocument::apply_override
  /// Text of the sequence file by detector; recording_profile for the others.
  std::map<std::string, std::string> profiles = {};
  /// Folder of the study, for the results of every filter's run and their pages in `runs` below it;
  /// none: these are not kept.
  std::optional<std::filesystem::path> runs_in = {};
  std::vector<std::string> command = {};  ///< the words of the command line, for these results
};

/// The methods of the study, in the order of its table:
/// - "detector": the detections themselves; "odometry": the odometry alone, aligned at the first
///   frame that has it and the true pose;
/// - "published_offline": rows "published: ACT" and so on, the published pixel errors of offline
///   pose-graph optimisation (Lu et al. 2022), where the data folder has their table; nothing is
///   run;
/// - "riekf", "riekf_gated": one hypothesis and one Gaussian, without and with a gate of 0.999;
/// - "riekf_cauchy": the same without a gate, under the Cauchy loss;
/// - "max_mixture": one hypothesis, for each detection the noise component of the largest weighted
///   likelihood; "rbpf": the particle filter; both with the noise model of the profile;
/// - "tangent_of_larger", "midway": the midway paper's filter (12 hypotheses, one noise component
///   for all objects of a frame, linearized update) with either rule of merging;
/// - "midway_iterated": the same with the iterated update;
/// - "published": the settings of the midway paper's own program; CosyPose recordings only;
/// - "default": the filter of the detector's profile; "default_smoothed": the same, smoothed over
///   the whole recording.
/// All but the last three share motion, start and measurement with the default. The
/// filters of one Gaussian and the paper's filter use the noise model `gaussian` of the profile for
/// DOPE's detections.
std::vector<std::string> ycbv_methods();

/// Reads the settings: the arrays `methods` (all of ycbv_methods where missing), `sequences`,
/// `objects`, `set` (overrides), and the table `profiles` with the path of a sequence file by
/// detector; with `reports` the runs are kept in `out`.
/// @throws InvalidInput as TomlTable does
YcbvStudySettings read_ycbv_settings(const TomlTable& table, const std::filesystem::path& out = {});

/// The study: one item per recording and method, one row per recording, object and method, then
/// the mean and the median by detector and method over the known values, and a summary against the
/// published numbers and the odometry. Its report holds study.json, ycbv.csv, summary.csv,
/// timing.csv (the only file that differs from run to run), errors.svg and camera.svg.
/// @throws InvalidInput for an unknown method, and when no recording fits the settings;
/// from items for a file that is not valid
Study make_ycbv_study(const YcbvStudySettings& settings);

}  // namespace posemix
