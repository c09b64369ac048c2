// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "descriptor.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
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

template <class Call>
auto Descriptor::called(const Call& call) const {
  if (on_signal_ == OnSignal::go_on) return uninterrupted(call);
  const auto result = call();
  if (result < 0) throw_if_interrupted(errno, shown_.string());
  return result;
}

Descriptor::Descriptor(const std::filesystem::path& path, int flags,
                       const std::filesystem::path& shown, OnSignal on_signal)
    : shown_(shown),
      on_signal_(on_signal),
      number_(called([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0666); })) {
  if (number_ < 0) fail_with_errno(shown_, "cannot be written");
}

Descriptor::~Descriptor() { ::close(number_); }

void Descriptor::write_all(std::string_view content) {
  // A pipe takes so much as a whole or not at all, and no signal is lost in the middle.
  const std::size_t most = on_signal_ == OnSignal::stop ? PIPE_BUF : content.size();
  while (!content.empty()) {
    const std::size_t size = std::min(content.size(), most);
    const ssize_t written = called([&] { return ::write(number_, content.data(), size); });
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
