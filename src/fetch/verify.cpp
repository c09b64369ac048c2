// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "verify.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "lock_file.hpp"
#include "posemix/base/error.hpp"

namespace posemix {
namespace {

using PinnedHashes = std::map<std::string_view, std::string_view>;

PinnedHashes pinned_hashes(const std::vector<DataSource>& sources, const LockFile& lock) {
  PinnedHashes pinned;
  for (const DataSource& source : sources) {
    if (source.name != lock.source || source.revision != lock.revision) continue;
    for (const SourceFile& file : source.files)
      if (!file.sha256.empty()) pinned.emplace(file.path, file.sha256);
  }
  return pinned;
}

/// The problem of a file; empty if there is none.
std::string problem_of(const std::string& path, const LockEntry& entry, const FileContent& content,
                       const PinnedHashes& pinned) {
  if (content.sha256 != entry.sha256) {
    return fmt::format("{}: got {} bytes of SHA-256 {}, expected {} of {} as fetched on {}", path,
                       content.size, content.sha256, entry.size, entry.sha256, entry.date);
  }
  const auto pin = pinned.find(path);
  if (pin == pinned.end() || pin->second == entry.sha256) return {};
  return fmt::format("{}: got SHA-256 {}, expected {} (the registry's)", path, entry.sha256,
                     pin->second);
}

}  // namespace

std::vector<std::filesystem::path> fetched_folders(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(folder))
    throw InvalidInput(folder.string() + ": is not there, expected a folder of fetched data");
  if (fs::exists(folder / kLockFileName)) return {folder};
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / kLockFileName)) found.push_back(entry.path());
  }
  if (found.empty()) {
    throw InvalidInput(
        fmt::format("{}: got no {} in it nor in a folder below it, expected data "
                    "that `posemix data fetch` wrote",
                    folder.string(), kLockFileName));
  }
  std::sort(found.begin(), found.end());
  return found;
}

Verification verify_folder(const std::filesystem::path& folder,
                           const std::vector<DataSource>& sources, const ByteProgress& progress) {
  const LockFile lock = read_lock_file(folder);
  const PinnedHashes pinned = pinned_hashes(sources, lock);
  Verification result{.folder = folder, .source = lock.source, .problems = {}};
  for (const auto& [path, entry] : lock.files) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(folder / path, ignored)) {
      result.problems.push_back(path + ": is not there");
      continue;
    }
    const auto content = content_of_file(folder / path, progress);
    if (!content) {
      result.stopped = true;
      break;
    }
    const std::string problem = problem_of(path, entry, *content, pinned);
    if (!problem.empty()) {
      result.problems.push_back(problem);
      continue;
    }
    ++result.right;
    if (entry.check == HashCheck::none) ++result.unchecked;
  }
  return result;
}

}  // namespace posemix
