// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "io/json_numbers.hpp"
#include "posemix/results/report.hpp"
#include "report_folder.hpp"

/// Parts of the data of a page.
namespace posemix::internal {

/// Passes warnings to the options' function, if there is one.
void warn(const std::vector<std::string>& warnings, const ReportOptions& options);

/// The last part of a path that has a name.
std::string last_name(const std::filesystem::path& path);

/// The keys that every page has, before its data.
Json report_head(ReportKind kind, const std::string& title);

/// The trace of the run in a folder, packed, with the intrinsics of the options' camera.
/// @throws InvalidInput naming the file and the place in it
Json read_packed_trace(const std::filesystem::path& folder, const ReportOptions& options);

/// The options' meshes by id.
/// @throws InvalidInput for a mesh of none of the objects
Json meshes_json(const ReportOptions& options, const std::set<std::string>& objects);

/// The options' images, by ascending stamps.
/// @throws InvalidInput for a folder without images, or images without stamps
Json images_json(const ReportOptions& options);

/// The folder that all paths are directly in.
/// @throws InvalidInput where there is none
std::filesystem::path common_parent(const std::vector<std::filesystem::path>& paths);

}  // namespace posemix::internal
