// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "input_files.hpp"

#include <mutex>
#include <set>
#include <utility>

#include <sys/stat.h>

#include <fmt/format.h>

#include "posemix/base/error.hpp"

namespace posemix::internal {
namespace {

/// A file by its device and its number there, whatever its name.
using FileNumber = std::pair<dev_t, ino_t>;

struct Inputs {
  std::mutex mutex;
  bool are_kept = false;
  std::set<FileNumber> read;
  std::set<FileNumber> written;
};

Inputs& inputs() {
  static Inputs kept;
  return kept;
}

}  // namespace

InputGuard::InputGuard() {
  const std::lock_guard lock(inputs().mutex);
  inputs().are_kept = true;
}

InputGuard::~InputGuard() {
  const std::lock_guard lock(inputs().mutex);
  inputs().are_kept = false;
  inputs().read.clear();
  inputs().written.clear();
}

void remember_input(std::FILE* file) {
  const std::lock_guard lock(inputs().mutex);
  struct stat status {};
  if (!inputs().are_kept || ::fstat(::fileno(file), &status) != 0 || !S_ISREG(status.st_mode))
    return;
  const FileNumber number{status.st_dev, status.st_ino};
  if (inputs().written.count(number) == 0) inputs().read.insert(number);
}

void remember_output(const std::filesystem::path& path) {
  const std::lock_guard lock(inputs().mutex);
  struct stat status {};
  if (inputs().are_kept && ::stat(path.c_str(), &status) == 0)
    inputs().written.insert({status.st_dev, status.st_ino});
}

void refuse_input(const std::filesystem::path& path) {
  const std::lock_guard lock(inputs().mutex);
  struct stat status {};
  if (!inputs().are_kept || ::stat(path.c_str(), &status) != 0) return;
  if (inputs().read.count({status.st_dev, status.st_ino}) == 0) return;
  throw InvalidInput(
      fmt::format("{}: is an input of this command and would be replaced, expected another place "
                  "for the result",
                  path.string()));
}

}  // namespace posemix::internal
