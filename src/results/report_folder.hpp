// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "io/json_numbers.hpp"

namespace posemix::internal {

enum class ReportKind { slam, mixture, salt_box, study, consistency };

/// The file that makes a folder one of consistency.
inline constexpr const char* kConsistencyFile = "consistency.json";

/// The files of a results folder that go into a report, by name, and the trace separately.
struct ReportFolder {
  ReportKind kind = ReportKind::slam;
  Json documents = Json::object();
  Json tables = Json::object();
  Json pictures = Json::object();
  Json texts = Json::object();
  std::vector<std::string> warnings;  ///< about keys under the names of the release before

  /// The entity that the mixtures describe: the second of their frames.
  std::set<std::string> mixture_frames() const;
};

/// Reads a results folder, or one mixture file.
/// @throws InvalidInput as format_report
ReportFolder read_report_folder(const std::filesystem::path& results);

}  // namespace posemix::internal
