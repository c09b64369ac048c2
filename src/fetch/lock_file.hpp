// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace posemix {

/// Name of the file beside fetched data that lists it.
inline constexpr std::string_view kLockFileName = "posemix-data.lock.json";

/// The hash that a fetched file was compared with.
enum class HashCheck { pinned, published, none };

/// Their names in files: "pinned", "published", "none".
std::string_view word_of(HashCheck check);

/// One fetched file.
struct LockEntry {
  std::string url;
  std::uint64_t size = 0;
  std::string sha256;
  HashCheck check = HashCheck::none;
  std::string date;  ///< time of the fetch, UTC, 2026-11-21T20:15:00Z
};

/// The fetched files of a folder.
struct LockFile {
  std::string source;
  std::string revision;
  std::map<std::string, LockEntry> files;  ///< entries by path below the folder
};

/// @throws InvalidInput naming file and key
LockFile parse_lock_file(std::string_view text, const std::string& name);
std::string format_lock_file(const LockFile& lock);

/// Reads the lock file of a folder; returns an empty one if the folder has none.
LockFile read_lock_file(const std::filesystem::path& folder);

/// The current time in the form of LockEntry::date.
std::string download_time();

}  // namespace posemix
