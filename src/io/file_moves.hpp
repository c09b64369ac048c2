// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <filesystem>
#include <vector>

namespace posemix::internal {

/// Where the file by which a folder is known as a result is kept while its files are replaced.
std::filesystem::path set_aside(const std::filesystem::path& path);

/// Moves files of one folder into another on the same file system. What they replace is kept in the
/// first folder, and is put back at the end unless all was well. Names are relative to both.
class FileMoves {
 public:
  FileMoves(std::filesystem::path from, std::filesystem::path to);
  /// Undoes everything without keep().
  ~FileMoves();
  FileMoves(const FileMoves&) = delete;
  FileMoves& operator=(const FileMoves&) = delete;

  /// Renames a file of the second folder that is there to its set_aside() path.
  /// @throws OutputError, as the others
  void put_aside(const std::filesystem::path& name);
  /// Puts a file in place, by one rename.
  void put(const std::filesystem::path& name);
  /// Takes a file or a link of the second folder away; what is not there, or is a folder, is left.
  void take_away(const std::filesystem::path& name);

  void keep() { kept_ = true; }

 private:
  /// A file of the second folder that was changed: where what it was is now, if there was one.
  struct Move {
    std::filesystem::path place;
    std::filesystem::path before;
  };

  std::filesystem::path kept_path();
  void undo() noexcept;

  std::filesystem::path from_;
  std::filesystem::path to_;
  std::vector<Move> moves_;
  bool kept_ = false;
};

}  // namespace posemix::internal
