// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/json_numbers.hpp"

namespace posemix::internal {

enum class ReportKind { slam, mixture, salt_box, study, consistency, comparison };

/// The file that makes a folder one of consistency.
inline constexpr const char* kConsistencyFile = "consistency.json";

/// The files of a results folder that go into a report, by name, and the trace separately.
struct ReportFolder {
  ReportKind kind = ReportKind::slam;
  Json documents = Json::object();
  Json tables = Json::object();
  Json pictures = Json::object();
  Json texts = Json::object();
  std::map<std::string, std::string> digests;  ///< SHA-256 of files that only some runs have
  std::vector<std::string> warnings;

  /// The entity that the mixtures describe: the second of their frames.
  std::set<std::string> mixture_frames() const;
};

/// The folders directly in a folder that have a run, sorted.
/// @throws InvalidInput when it cannot be read
std::vector<std::filesystem::path> runs_in(const std::filesystem::path& folder);

/// Whether a folder has no results of its own, but several runs within.
bool holds_runs(const std::filesystem::path& folder);

/// Reads a results folder, or one mixture file.
/// @throws InvalidInput as format_report
ReportFolder read_report_folder(const std::filesystem::path& results);

}  // namespace posemix::internal
