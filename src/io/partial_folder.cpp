// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "partial_folder.hpp"

#include <cerrno>
#include <csignal>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "posemix/io/text.hpp"

namespace posemix::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAttempts = 1000;

/// A descriptor of the folder that has its lock; -1 where somebody else has it, or it is none.
int locked(const fs::path& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return -1;
  if (::flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
  ::close(folder);
  return -1;
}

/// Whether the path is still that of the folder.
bool is_at(const fs::path& path, int folder) {
  struct stat named {};
  struct stat opened {};
  return ::lstat(path.c_str(), &named) == 0 && ::fstat(folder, &opened) == 0 &&
         named.st_dev == opened.st_dev && named.st_ino == opened.st_ino;
}

/// Whether a name is `stem`<process> or `stem`<process>-<number>, of a process that is not there.
bool is_of_dead_process(std::string_view name, std::string_view stem) {
  if (!name.starts_with(stem)) return false;
  const auto words = split_fields(name.substr(stem.size()), '-');
  const auto process = parse_integer(words.front());
  const bool fits = words.size() == 1 || (words.size() == 2 && parse_integer(words[1]));
  return fits && process && *process > 0 && ::kill(static_cast<pid_t>(*process), 0) != 0 &&
         errno == ESRCH;
}

/// On another machine the process may be there, but then the folder is locked.
void remove_left_behind(const fs::path& parent, std::string_view stem) {
  std::vector<fs::path> left;
  std::error_code error;
  for (fs::directory_iterator at(parent, error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    if (is_of_dead_process(at->path().filename().string(), stem)) left.push_back(at->path());
  }
  for (const fs::path& path : left) {
    const int folder = locked(path);
    if (folder < 0) continue;
    fs::remove_all(path, error);
    ::close(folder);
  }
}

}  // namespace

std::optional<PartialFolder> PartialFolder::create(const fs::path& parent, const fs::path& name) {
  const std::string stem = fmt::format(".{}.partial-", name.string());
  remove_left_behind(parent, stem);
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    const fs::path path =
        parent / (attempt == 0 ? fmt::format("{}{}", stem, ::getpid())
                               : fmt::format("{}{}-{}", stem, ::getpid(), attempt));
    if (::mkdir(path.c_str(), 0777) != 0) {
      if (errno == EEXIST) continue;
      return std::nullopt;
    }
    const int folder = locked(path);
    // A file system without locks is written to all the same.
    if (folder < 0 || is_at(path, folder)) return PartialFolder(path, folder);
    ::close(folder);
  }
  return std::nullopt;
}

PartialFolder::PartialFolder(fs::path path, int lock) : path_(std::move(path)), lock_(lock) {}

PartialFolder::PartialFolder(PartialFolder&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

PartialFolder::~PartialFolder() {
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace posemix::internal
