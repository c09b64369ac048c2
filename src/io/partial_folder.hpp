// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <optional>

namespace posemix::internal {

/// A hidden folder `.<name>.partial-<process>` that is locked as long as this object is there, by
/// which others know that somebody works in it.
class PartialFolder {
 public:
  /// A new one in `parent`, or nothing, with errno set. Those of the same name that dead processes
  /// have left behind are removed.
  static std::optional<PartialFolder> create(const std::filesystem::path& parent,
                                             const std::filesystem::path& name);
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;
  PartialFolder(PartialFolder&& other) noexcept;
  PartialFolder& operator=(PartialFolder&&) = delete;
  ~PartialFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  PartialFolder(std::filesystem::path path, int lock);

  std::filesystem::path path_;
  int lock_;
};

}  // namespace posemix::internal
