// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "io/json_numbers.hpp"

namespace posemix {

enum class ReportKind { slam, mixture, salt_box, study };

/// Files of a results folder as a report holds them, by name; the trace apart.
struct ReportFolder {
  ReportKind kind = ReportKind::slam;
  Json documents = Json::object();
  Json tables = Json::object();
  Json pictures = Json::object();
  Json texts = Json::object();
  std::vector<std::string> warnings;  ///< about keys under the names of the release before

  /// What the mixtures are of, the second of their frames.
  std::set<std::string> mixture_frames() const;
};

/// Reads a results folder, or one mixture file.
/// @throws InvalidInput as format_report
ReportFolder read_report_folder(const std::filesystem::path& results);

}  // namespace posemix
