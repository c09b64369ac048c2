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

/// How far a fetch is.
struct FetchProgress {
  std::size_t files_done = 0;
  std::size_t files = 0;
  std::uint64_t bytes_done = 0;
  std::optional<std::uint64_t> bytes;  ///< where the sizes of all files are known
};

/// False stops the fetch.
using FetchWatcher = std::function<bool(const FetchProgress&)>;

struct FetchReport {
  std::size_t fetched = 0;        ///< files that came over the network
  std::size_t there_already = 0;  ///< files that were there and are right
  std::uint64_t bytes = 0;        ///< of all of them
  std::size_t pinned = 0;         ///< compared with a hash of the registry
  std::size_t published = 0;      ///< compared with the hash that the host publishes
  std::size_t unchecked = 0;      ///< nothing to compare with
  bool stopped = false;
  std::optional<std::filesystem::path> part;  ///< what there is of the file it stopped in
};

/// The files of a source that match one of the patterns ('*' stands for any characters); without
/// patterns those that are not optional. @throws InvalidInput for a pattern that none matches
std::vector<SourceFile> selected_files(const DataSource& source,
                                       const std::vector<std::string>& patterns);

/// Fetches files into a folder and notes them in its lock file. A file in flight is `NAME.part`,
/// and is resumed; it takes its name when its hash is right. A file that is there is compared.
/// @throws InvalidInput when a file is not what it should be (the fetched one is removed, one that
/// was there stays), NetworkError, OutputError
FetchReport fetch_files(const DataSource& source, const std::vector<SourceFile>& files,
                        const std::filesystem::path& folder, const ConnectionSettings& settings,
                        const FetchWatcher& watcher = {});

/// Size and hash in a Git LFS pointer. @throws InvalidInput
FileContent parse_lfs_pointer(std::string_view text, const std::string& name);

}  // namespace posemix
