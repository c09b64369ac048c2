// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <string_view>

/// The names of files in folders of results.
namespace posemix::internal {

/// Whether a run writes files of such a name, its objects' names apart, a report among them.
bool is_run_name(std::string_view name);

/// The same for consistency_files, without a report.
bool is_consistency_name(std::string_view name);
/// The report of a folder, which the next result there removes.
bool is_report_name(std::string_view name);

}  // namespace posemix::internal
