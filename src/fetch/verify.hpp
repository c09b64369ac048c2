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

/// Fetched data compared with its lock file and with the registry.
struct Verification {
  std::filesystem::path folder;
  std::string source;
  std::size_t right = 0;
  std::size_t unchecked = 0;          ///< of the right ones, those that were fetched with no hash
  std::vector<std::string> problems;  ///< one line per file that is not right
  bool stopped = false;
};

/// The folders of fetched data at `folder`: itself, else those right below it, sorted.
/// @throws InvalidInput where there is none
std::vector<std::filesystem::path> fetched_folders(const std::filesystem::path& folder);

/// Compares every file of a folder's lock file; of a registry's source also with its hashes.
/// @throws InvalidInput for a lock file that cannot be read
Verification verify_folder(const std::filesystem::path& folder,
                           const std::vector<DataSource>& sources,
                           const ByteProgress& progress = {});

}  // namespace posemix
