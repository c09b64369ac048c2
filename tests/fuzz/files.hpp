// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "io/temporary_folder.hpp"

/// Bytes as files, for what opens them itself.
namespace posemix::fuzzing {

/// A file with the bytes, until the next one.
inline std::filesystem::path file_of(std::string_view bytes) {
  static const posemix::testing::TemporaryFolder folder;
  return folder.put("f", bytes);
}

/// The first line as the name of a file in a folder, and what follows as its content. Only what
/// cannot leave the folder is kept of the line.
struct NamedFile {
  explicit NamedFile(std::string_view bytes) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    for (const char c : bytes.substr(0, std::min(end, kMostLetters)))
      name += std::string_view("/\0", 2).find(c) == std::string_view::npos ? c : '-';
    if (name.find_first_not_of('.') == std::string::npos) name = "-";
    content = bytes.substr(std::min(end + 1, bytes.size()));
  }
  static constexpr std::size_t kMostLetters = 100;
  std::string name;
  std::string_view content;
};

}  // namespace posemix::fuzzing
