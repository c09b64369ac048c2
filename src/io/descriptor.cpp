// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "descriptor.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/uninterrupted.hpp"
#include "posemix/io/output_folder.hpp"

namespace posemix::internal {
void fail_output(const std::filesystem::path& path, std::string_view what,
                 std::string_view reason) {
  throw OutputError(fmt::format("{}: {}: {}", path.string(), what, reason));
}

void fail_with_errno(const std::filesystem::path& path, std::string_view what) {
  fail_output(path, what, std::strerror(errno));
}

Descriptor::Descriptor(const std::filesystem::path& path, int flags,
                       const std::filesystem::path& shown)
    : shown_(shown),
      number_(uninterrupted([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0666); })) {
  if (number_ < 0) fail_with_errno(shown_, "cannot be written");
}

Descriptor::~Descriptor() { ::close(number_); }

void Descriptor::write_all(std::string_view content) {
  while (!content.empty()) {
    const ssize_t written =
        uninterrupted([&] { return ::write(number_, content.data(), content.size()); });
    if (written < 0) fail_with_errno(shown_, "cannot be written");
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

void Descriptor::sync() {
  const int status = uninterrupted([&] { return ::fsync(number_); });
  if (status != 0 && errno != EINVAL && errno != EROFS) {
    fail_with_errno(shown_, "cannot be written to the disk");
  }
}

FolderEntries::FolderEntries(const std::filesystem::path& folder,
                             const std::filesystem::path& shown) {
  const bool is_unreadable = ::access(folder.c_str(), R_OK) != 0 && errno == EACCES;
  if (!is_unreadable) folder_.emplace(folder, O_RDONLY | O_DIRECTORY, shown);
}

void FolderEntries::sync() {
  if (folder_) folder_->sync();
}

void sync_folder(const std::filesystem::path& folder) { FolderEntries(folder, folder).sync(); }

}  // namespace posemix::internal
