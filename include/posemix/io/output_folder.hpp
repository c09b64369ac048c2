// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace posemix {
namespace internal {
class PartialFolder;
}

/// An error of the system when writing output: the message names the path and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Takes a text piece by piece.
using TextSink = std::function<void(std::string_view)>;

/// A folder of results that appears as a whole or not at all.
///
/// Files are written into a hidden folder `.<name>.partial-<process>` beside the target, and
/// commit() moves them to the target. A target that is missing or empty is replaced by one rename;
/// in a target with files, each file is replaced by a rename of its own, and other files stay but
/// for those that remove_earlier() names; where one of them cannot be replaced, all are put back.
/// (If the target is a mount point, or its parent cannot be written, the hidden folder is inside
/// it.) Files are on the disk before they are renamed. Without commit() the destructor removes the
/// hidden folder and every parent folder that the constructor created; that of a process that was
/// killed is removed by the next one that writes the same target. Every member throws OutputError.
class OutputFolder {
 public:
  /// Creates the hidden folder and missing parents of the target.
  /// @throws OutputError, also when the target exists and is not a folder
  explicit OutputFolder(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Writes one file. `name` is relative to the folder, may contain sub-folders (which are created)
  /// and can be written only once.
  void write(const std::filesystem::path& name, std::string_view content);

  /// The same for a text that comes in pieces: `content` is called with the function that takes
  /// them.
  void write(const std::filesystem::path& name,
             const std::function<void(const TextSink&)>& content);

  /// Names files of earlier results in the target: commit() removes those that are not written,
  /// when the others are in place. Those that are not there, and folders, are left aside.
  void remove_earlier(const std::vector<std::filesystem::path>& names);

  /// Names the file without which the folder is no result. In a target with files it is set aside
  /// first, as `.<name>.replaced`, and put in place last: a process that is killed in between
  /// leaves a folder without it, and never one with files of two results.
  void put_last(const std::filesystem::path& name);

  /// Moves the files to the target. Nothing can be written afterwards.
  void commit();

  /// The absolute path of the target.
  const std::filesystem::path& target() const { return target_; }
  /// A folder on the disk of the target for files without a name, until commit().
  const std::filesystem::path& scratch() const { return hidden_path_; }

 private:
  void create_parents();
  void create_hidden();
  bool create_hidden_in(const std::filesystem::path& folder);
  void move_files();
  bool is_written(const std::filesystem::path& name) const;
  void remove_traces() noexcept;

  std::filesystem::path target_;
  std::unique_ptr<internal::PartialFolder> hidden_;
  std::filesystem::path hidden_path_;
  std::vector<std::filesystem::path> created_parents_;  // innermost first
  std::vector<std::filesystem::path> names_;
  std::vector<std::filesystem::path> earlier_;
  std::filesystem::path last_;
  bool committed_ = false;
};

}  // namespace posemix
