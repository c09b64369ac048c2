// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace posemix {

/// Name of the file beside fetched data that says what was fetched.
inline constexpr std::string_view kLockFileName = "posemix-data.lock.json";

/// What a fetched file was compared with.
enum class HashCheck { pinned, published, none };

/// The words for them in files: "pinned", "published", "none".
std::string_view word_of(HashCheck check);

/// One fetched file.
struct LockEntry {
  std::string url;
  std::uint64_t size = 0;
  std::string sha256;
  HashCheck check = HashCheck::none;
  std::string date;  ///< of the fetch, UTC, 2026-11-21T20:15:00Z
};

/// What a folder of fetched data holds.
struct LockFile {
  std::string source;
  std::string revision;
  std::map<std::string, LockEntry> files;  ///< by path below the folder
};

/// @throws InvalidInput naming file and key
LockFile parse_lock_file(std::string_view text, const std::string& name);
std::string format_lock_file(const LockFile& lock);

/// The lock file of a folder; an empty one where there is none.
LockFile read_lock_file(const std::filesystem::path& folder);

/// The time now, as in LockEntry::date.
std::string utc_now();

}  // namespace posemix
