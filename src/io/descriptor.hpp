// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace posemix::internal {

/// @throws OutputError `path: what: reason`
[[noreturn]] void fail_output(const std::filesystem::path& path, std::string_view what,
                              std::string_view reason);
/// As fail_output, with the reason from errno.
/// @throws OutputError `path: what: reason`
[[noreturn]] void fail_with_errno(const std::filesystem::path& path, std::string_view what);

/// What a call that is interrupted by a signal does. What may wait for ever, as a pipe that nobody
/// reads, stops with a std::system_error (std::errc::interrupted).
enum class OnSignal { go_on, stop };

/// A file descriptor that closes itself. Every member throws OutputError.
class Descriptor {
 public:
  /// `shown` is the path in messages.
  Descriptor(const std::filesystem::path& path, int flags, const std::filesystem::path& shown,
             OnSignal on_signal = OnSignal::go_on);
  Descriptor(const std::filesystem::path& path, int flags) : Descriptor(path, flags, path) {}
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write_all(std::string_view content);
  /// Waits until the content is on the disk. A file system that does not support this is accepted.
  void sync();

 private:
  template <class Call>
  auto called(const Call& call) const;

  std::filesystem::path shown_;
  OnSignal on_signal_;
  int number_;
};

/// The entries of a folder. Those of one that may be written to and not read cannot be waited for,
/// which is accepted, too.
class FolderEntries {
 public:
  /// `shown` is the path in messages.
  /// @throws OutputError without a descriptor for them
  FolderEntries(const std::filesystem::path& folder, const std::filesystem::path& shown);

  /// Waits until they are on the disk.
  void sync();

 private:
  std::optional<Descriptor> folder_;
};

/// Waits until the entries of a folder are on the disk.
void sync_folder(const std::filesystem::path& folder);

}  // namespace posemix::internal
