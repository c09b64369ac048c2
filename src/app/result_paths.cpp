// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "result_paths.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace posemix {
namespace {

namespace fs = std::filesystem;

/// The path without links and dots; none for the standard output and for what is no file. What
/// cannot be followed is refused when it is written.
std::optional<fs::path> plain_path(const NamedResult& result) {
  if (!result.path || result.path->empty() || *result.path == "-") return std::nullopt;
  std::error_code error;
  const fs::file_status status = fs::status(*result.path, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    return std::nullopt;
  fs::path path = fs::weakly_canonical(fs::absolute(*result.path, error), error);
  if (error) return std::nullopt;
  return path.has_filename() ? path : path.parent_path();
}

/// Also of two names of one file.
bool is_one(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  return a == b || fs::equivalent(a, b, missing);
}

}  // namespace

void require_different_files(std::span<const NamedResult> files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto path = plain_path(files[i]);
    for (std::size_t k = 0; path && k < i; ++k) {
      const auto other = plain_path(files[k]);
      if (!other || !is_one(*path, *other)) continue;
      throw CLI::ValidationError(
          files[i].option, fmt::format("is the file of {}, expected another one", files[k].option));
    }
  }
}

void require_beside_folder(std::span<const NamedResult> files, const NamedResult& folder,
                           const IsResultName& is_result) {
  const auto target = plain_path(folder);
  if (!target) return;
  for (const NamedResult& file : files) {
    const auto path = plain_path(file);
    if (!path) continue;
    const bool is_inside = is_one(path->parent_path(), *target);
    const bool replaces = is_inside && is_result(path->filename().string());
    if (!replaces && !is_one(*path, *target)) continue;
    throw CLI::ValidationError(
        file.option, replaces
                         ? fmt::format("{} is a result in the folder of {}, expected another file",
                                       *file.path, folder.option)
                         : fmt::format("is the folder of {}, expected a file", folder.option));
  }
}

}  // namespace posemix
