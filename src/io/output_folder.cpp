// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_folder.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

namespace posemix {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAttempts = 1000;

[[noreturn]] void fail(const fs::path& path, std::string_view what, std::string_view reason) {
  throw OutputError(fmt::format("{}: {}: {}", path.string(), what, reason));
}

[[noreturn]] void fail_with_errno(const fs::path& path, std::string_view what) {
  fail(path, what, std::strerror(errno));
}

void check(const std::error_code& error, const fs::path& path, std::string_view what) {
  if (error) fail(path, what, error.message());
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags)
      : path_(path), number_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (number_ < 0) fail_with_errno(path_, "cannot be written");
  }
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write_all(std::string_view content) {
    while (!content.empty()) {
      const ssize_t written = ::write(number_, content.data(), content.size());
      if (written < 0 && errno != EINTR) fail_with_errno(path_, "cannot be written");
      if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  /// Waits until the content is on the disk; file systems that cannot say so are taken at their
  /// word.
  void sync() {
    if (::fsync(number_) != 0 && errno != EINVAL && errno != EROFS) {
      fail_with_errno(path_, "cannot be written to the disk");
    }
  }

 private:
  fs::path path_;
  int number_;
};

void sync_folder(const fs::path& folder) { Descriptor(folder, O_RDONLY | O_DIRECTORY).sync(); }

fs::path resolved(const fs::path& target) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(target, error), error);
  check(error, target, "cannot be written");
  if (!path.has_filename()) path = path.parent_path();
  if (target.empty() || !path.has_filename())
    fail(target, "cannot be written", "not a folder name");
  return path;
}

/// True too where the target is missing.
bool on_one_device(const fs::path& target, const fs::path& parent) {
  struct stat of_target {};
  struct stat of_parent {};
  if (::stat(target.c_str(), &of_target) != 0) return true;
  return ::stat(parent.c_str(), &of_parent) == 0 && of_target.st_dev == of_parent.st_dev;
}

bool stays_inside(const fs::path& name) {
  if (name.is_absolute() || !name.has_filename()) return false;
  for (const fs::path& part : name) {
    if (part == ".." || part == ".") return false;
  }
  return true;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target) : target_(resolved(target)) {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_directory(status))
    fail(target_, "cannot be written", "not a folder");
  try {
    create_parents();
    create_hidden();
  } catch (...) {
    remove_traces();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  if (!committed_) remove_traces();
}

void OutputFolder::create_parents() {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path parent = target_.parent_path(); !fs::exists(parent, error) && !error;
       parent = parent.parent_path()) {
    missing.insert(missing.begin(), parent);
  }
  for (const fs::path& parent : missing) {
    const bool created = fs::create_directory(parent, error);
    check(error, parent, "cannot be created");
    if (created) created_parents_.insert(created_parents_.begin(), parent);
  }
}

bool OutputFolder::create_hidden_in(const fs::path& folder) {
  const std::string stem = fmt::format(".{}.partial-{}", target_.filename().string(), ::getpid());
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    const fs::path path = folder / (attempt == 0 ? stem : fmt::format("{}-{}", stem, attempt));
    if (::mkdir(path.c_str(), 0777) == 0) {
      hidden_ = path;
      return true;
    }
    if (errno != EEXIST) return false;
  }
  return false;
}

void OutputFolder::create_hidden() {
  const fs::path parent = target_.parent_path();
  const bool beside = on_one_device(target_, parent);
  if (beside && create_hidden_in(parent)) return;
  const int reason = errno;
  std::error_code ignored;
  if (fs::is_directory(target_, ignored) && create_hidden_in(target_)) return;
  if (beside) errno = reason;
  fail_with_errno(target_, "cannot be created");
}

void OutputFolder::remove_traces() noexcept {
  std::error_code ignored;
  if (!hidden_.empty()) fs::remove_all(hidden_, ignored);
  for (const fs::path& parent : created_parents_) ::rmdir(parent.c_str());
}

void OutputFolder::write(const fs::path& name, std::string_view content) {
  if (committed_) fail(target_ / name, "cannot be written", "the folder is already in place");
  if (!stays_inside(name)) fail(name, "cannot be written", "not a file name within the folder");
  const fs::path path = hidden_ / name;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  check(error, path.parent_path(), "cannot be created");
  Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL);
  file.write_all(content);
  file.sync();
  names_.push_back(name);
}

void OutputFolder::move_files() {
  std::error_code error;
  for (const fs::path& name : names_) {
    const fs::path path = target_ / name;
    if (fs::is_directory(path, error)) fail(path, "cannot be replaced", "is a folder");
    fs::create_directories(path.parent_path(), error);
    check(error, path.parent_path(), "cannot be created");
  }
  for (const fs::path& name : names_) {
    const fs::path path = target_ / name;
    if (::rename((hidden_ / name).c_str(), path.c_str()) != 0) {
      fail_with_errno(path, "cannot be replaced");
    }
    sync_folder(path.parent_path());
  }
  fs::remove_all(hidden_, error);
}

void OutputFolder::commit() {
  if (committed_) fail(target_, "cannot be committed", "the folder is already in place");
  sync_folder(hidden_);
  if (::rename(hidden_.c_str(), target_.c_str()) != 0) {
    const bool filled = errno == ENOTEMPTY || errno == EEXIST;
    const bool inside = hidden_.parent_path() == target_;
    if (!filled && !inside) fail_with_errno(target_, "cannot be put in place");
    move_files();
  }
  committed_ = true;
  sync_folder(target_.parent_path());
}

}  // namespace posemix
