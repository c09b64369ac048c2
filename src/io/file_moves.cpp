// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "file_moves.hpp"

#include <cerrno>
#include <system_error>

#include <unistd.h>

#include <fmt/format.h>

#include "descriptor.hpp"

namespace posemix::internal {
namespace {

namespace fs = std::filesystem;

void rename(const fs::path& from, const fs::path& to, const fs::path& shown,
            std::string_view what) {
  if (::rename(from.c_str(), to.c_str()) != 0) fail_with_errno(shown, what);
}

bool is_file_or_link(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  return fs::is_regular_file(status) || fs::is_symlink(status);
}

}  // namespace

fs::path set_aside(const fs::path& path) {
  return path.parent_path() / fmt::format(".{}.replaced", path.filename().string());
}

FileMoves::FileMoves(fs::path from, fs::path to) : from_(std::move(from)), to_(std::move(to)) {}

FileMoves::~FileMoves() {
  if (!kept_) undo();
}

/// A name of its own in the first folder, whose files may have any name but this.
fs::path FileMoves::kept_path() { return from_ / fmt::format(".replaced-{}", moves_.size()); }

void FileMoves::put_aside(const fs::path& name) {
  const fs::path path = to_ / name;
  if (!is_file_or_link(path)) return;
  rename(path, set_aside(path), path, "cannot be replaced");
  moves_.push_back({path, set_aside(path)});
  sync_folder(path.parent_path());
}

void FileMoves::put(const fs::path& name) {
  const fs::path path = to_ / name;
  Move move{path, {}};
  if (is_file_or_link(path)) {
    // Not every file system has a second name for a file; then this one cannot be put back.
    move.before = kept_path();
    if (::link(path.c_str(), move.before.c_str()) != 0) move.place.clear();
  }
  rename(from_ / name, path, path, "cannot be replaced");
  moves_.push_back(std::move(move));
  sync_folder(path.parent_path());
}

void FileMoves::take_away(const fs::path& name) {
  const fs::path path = to_ / name;
  if (!is_file_or_link(path)) return;
  const fs::path kept = kept_path();
  rename(path, kept, path, "cannot be removed");
  moves_.push_back({path, kept});
}

void FileMoves::undo() noexcept {
  for (; !moves_.empty(); moves_.pop_back()) {
    const auto& [place, before] = moves_.back();
    if (place.empty()) continue;
    if (before.empty()) {
      ::unlink(place.c_str());
    } else {
      ::rename(before.c_str(), place.c_str());
    }
  }
}

}  // namespace posemix::internal
