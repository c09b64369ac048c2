// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

/// Files that a command has read, which its results must not replace.
namespace posemix::internal {

/// While one lives, the files that read_file() reads are remembered. There is one at a time.
class InputGuard {
 public:
  InputGuard();
  ~InputGuard();
  InputGuard(const InputGuard&) = delete;
  InputGuard& operator=(const InputGuard&) = delete;
};

/// Remembers an open file, which is no result of the same command.
void remember_input(std::FILE* file);
/// The file is a result: a report may read it, and it may be replaced again.
void remember_output(const std::filesystem::path& path);

/// read_file() for results of before, which are no input and may be replaced.
std::string read_earlier_file(const std::filesystem::path& path);

/// @throws InvalidInput when the file that is at `path` was read
void refuse_input(const std::filesystem::path& path);

}  // namespace posemix::internal
