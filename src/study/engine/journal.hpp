// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "items.hpp"
#include "study.hpp"

namespace posemix {

class LineReader;

/// The file of finished items of a study in progress.
///
/// The first line is JSON with the study's name, settings and vector instructions; one line per
/// finished item follows, with a checksum. Lines are handed to the system before append() returns,
/// so a process that dies loses no item of the journal; an incomplete last line is cut off, at once
/// where the disk is full. The file is locked against a second process. A journal without a
/// finished item is removed in the end, because there is nothing to continue.
class Journal {
 public:
  /// Creates the file, or continues an existing one.
  /// @throws InvalidInput when it holds items and `resume` is not set, when it belongs to another
  /// study, to other settings or to other vector instructions than those of this process, or is
  /// damaged
  /// @throws OutputError when it cannot be written, or another process has locked it
  Journal(std::filesystem::path path, const Study& study, bool resume);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// The results that were in the file when it was opened, by item.
  const std::map<std::size_t, std::string>& finished() const { return finished_; }

  /// The vector instructions of all its items; empty for a journal of a program before 0.3, which
  /// did not say.
  const std::string& instructions() const { return instructions_; }

  /// @throws OutputError
  void append(std::span<const FinishedItem> items);

 private:
  void read(const Study& study, bool resume);
  void read_item(LineReader& lines, const Study& study);
  void read_head(LineReader& lines, const Study& study);
  void write_head(const Study& study);
  void cut_to(std::size_t size);
  void write(std::string_view lines);
  [[noreturn]] void fail_to_write();

  std::filesystem::path path_;
  int file_;
  std::size_t size_ = 0;    ///< of the whole lines
  bool is_checked_ = true;  ///< false for a journal of a program before 0.4
  bool holds_items_ = false;
  std::map<std::size_t, std::string> finished_;
  std::string instructions_;
};

}  // namespace posemix
