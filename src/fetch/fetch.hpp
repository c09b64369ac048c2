// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "download.hpp"
#include "lock_file.hpp"
#include "sources.hpp"

namespace posemix {

/// Progress of a fetch.
struct FetchProgress {
  std::size_t files_done = 0;
  std::size_t files = 0;
  std::uint64_t bytes_done = 0;
  std::optional<std::uint64_t> bytes;  ///< [bytes] in all, if the sizes of all files are known
};

/// Called with the progress; returning false stops the fetch.
using FetchWatcher = std::function<bool(const FetchProgress&)>;

struct FetchReport {
  std::size_t fetched = 0;        ///< files that came over the network
  std::size_t there_already = 0;  ///< files that existed and are intact
  std::uint64_t bytes = 0;        ///< size of all files
  std::size_t pinned = 0;         ///< compared with a hash of the registry
  std::size_t published = 0;      ///< compared with the hash that the host publishes
  std::size_t unchecked = 0;      ///< no hash to compare with
  bool stopped = false;
  std::optional<std::filesystem::path> part;  ///< the unfinished file of a stopped fetch
};

/// The files of a source that match one of the patterns ('*' stands for any characters); without
/// patterns those that are not optional.
/// @throws InvalidInput for a pattern that matches no file
std::vector<SourceFile> selected_files(const DataSource& source,
                                       const std::vector<std::string>& patterns);

/// Fetches files into a folder and lists them in its lock file. A file in transfer is `NAME.part`,
/// and is resumed; it takes its name when its hash is correct. An existing file is compared.
/// @throws InvalidInput when a hash or size differs (a fetched file is removed, an existing one
/// stays), NetworkError, OutputError
FetchReport fetch_files(const DataSource& source, const std::vector<SourceFile>& files,
                        const std::filesystem::path& folder, const ConnectionSettings& settings,
                        const FetchWatcher& watcher = {});

/// Size and hash in a Git LFS pointer. @throws InvalidInput
FileContent parse_lfs_pointer(std::string_view text, const std::string& name);

}  // namespace posemix
