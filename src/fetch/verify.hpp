// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "checksum.hpp"
#include "sources.hpp"

namespace posemix {

/// Compares fetched data with its lock file and with the registry.
struct Verification {
  std::filesystem::path folder;
  std::string source;
  std::size_t right = 0;
  std::size_t unchecked = 0;          ///< intact files that were fetched without a hash
  std::vector<std::string> problems;  ///< one line per damaged or missing file
  bool stopped = false;
};

/// The folders of fetched data at `folder`: the folder itself, or else its direct subfolders,
/// sorted.
/// @throws InvalidInput if there is none
std::vector<std::filesystem::path> fetched_folders(const std::filesystem::path& folder);

/// Compares every file with the folder's lock file and, if its source is in the registry, with the
/// hashes there.
/// @throws InvalidInput for a lock file that cannot be read
Verification verify_folder(const std::filesystem::path& folder,
                           const std::vector<DataSource>& sources,
                           const ByteProgress& progress = {});

}  // namespace posemix
