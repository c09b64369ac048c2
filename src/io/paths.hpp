// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <vector>

/// What is at a path, without the exceptions of the file system: of what cannot be looked at, or is
/// no path, nothing is there.
namespace posemix::internal {

inline bool is_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

inline bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

/// The path from the root, without dots.
/// @throws InvalidInput for an empty path, and where the folder of the process is gone
std::filesystem::path absolute_path(const std::filesystem::path& path);

/// What is in a folder, in order.
/// @throws InvalidInput when the folder cannot be read
std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

}  // namespace posemix::internal
