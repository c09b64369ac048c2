// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "study.hpp"

namespace posemix {

/// The finished items of a study that is not done yet, in a file.
///
/// A line of JSON that names the study and its settings, then one line per finished item. A line is
/// handed to the system before append() returns, so a process that dies loses no finished item; a
/// last line that was cut off is ignored. The file is locked against a second process. A journal in
/// which no item was ever finished is removed in the end: there is nothing to continue.
class Journal {
 public:
  /// Creates the file, or continues with the one that is there.
  /// @throws InvalidInput when there is one and `resume` is not set, when it is that of another
  /// study or of other settings, or is damaged
  /// @throws OutputError when it cannot be written, or another process holds it
  Journal(std::filesystem::path path, const Study& study, bool resume);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Results that the file held when it was opened, by item.
  const std::map<std::size_t, std::string>& finished() const { return finished_; }

  /// @throws OutputError
  void append(std::size_t item, std::string_view result);

 private:
  void read(const Study& study);
  void write(std::string_view line);

  std::filesystem::path path_;
  int file_;
  bool holds_items_ = false;
  std::map<std::size_t, std::string> finished_;
};

}  // namespace posemix
