// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <string>

#include "report_folder.hpp"

namespace posemix::internal {

/// Takes the files of other runs out of the folder of a run, with a warning for each, and renames
/// what metrics.json has under the names of the release before. `metrics` is its name.
void keep_files_of_run(ReportFolder& folder, const std::filesystem::path& path,
                       const std::string& metrics);

/// @throws InvalidInput unless the trace is of the run of metrics.json
void require_one_run(const Json& trace, const Json& metrics, const std::filesystem::path& path);

}  // namespace posemix::internal
