// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "io/paths.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {

namespace fs = std::filesystem;

fs::path absolute_path(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (error || path.empty())
    throw InvalidInput(
        fmt::format("'{}' is no path: {}", path.string(), error ? error.message() : "it is empty"));
  return absolute.lexically_normal();
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error))
    entries.push_back(entry->path());
  if (error)
    throw InvalidInput(
        fmt::format("{}: the folder cannot be read: {}", folder.string(), error.message()));
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace posemix::internal
