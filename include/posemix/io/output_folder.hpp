// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace posemix {

/// Output that the system refused: the message names the path and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A folder of results that appears as a whole or not at all.
///
/// Files are written into a hidden folder `.<name>.partial-<process>` beside the target, and
/// commit() puts them in their place: a target that is missing or empty is replaced by one rename;
/// in a target that holds files, each file is replaced by a rename of its own and other files stay.
/// (A target that is a mount point, or whose parent cannot be written, has the hidden folder
/// inside.) Files are on the disk before they are renamed. Without commit() the destructor removes
/// the hidden folder and every parent folder that the constructor created. Every member throws
/// OutputError.
class OutputFolder {
 public:
  /// Creates the hidden folder (and the target's missing parents). Throws too when the target is
  /// there and is no folder.
  explicit OutputFolder(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Writes one file. `name` is relative to the folder, may lie in sub-folders (which are created)
  /// and may not be written twice.
  void write(const std::filesystem::path& name, std::string_view content);

  /// Puts the folder in its place. Nothing can be written afterwards.
  void commit();

  /// The folder that commit() puts in place, absolute.
  const std::filesystem::path& target() const { return target_; }

 private:
  void create_parents();
  void create_hidden();
  bool create_hidden_in(const std::filesystem::path& folder);
  void move_files();
  void remove_traces() noexcept;

  std::filesystem::path target_;
  std::filesystem::path hidden_;
  std::vector<std::filesystem::path> created_parents_;  // innermost first
  std::vector<std::filesystem::path> names_;
  bool committed_ = false;
};

}  // namespace posemix
