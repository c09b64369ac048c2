// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "descriptor.hpp"
#include "file_moves.hpp"
#include "input_files.hpp"
#include "partial_folder.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

void check(const std::error_code& error, const fs::path& path, std::string_view what) {
  if (error) fail_output(path, what, error.message());
}

fs::path resolved(const fs::path& target) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(target, error), error);
  check(error, target, "cannot be written");
  if (!path.has_filename()) path = path.parent_path();
  if (target.empty() || !path.has_filename())
    fail_output(target, "cannot be written", "not a folder name");
  return path;
}

/// Whether target and parent are on the same device; true also for a missing target.
bool on_one_device(const fs::path& target, const fs::path& parent) {
  struct stat of_target {};
  struct stat of_parent {};
  if (::stat(target.c_str(), &of_target) != 0) return true;
  return ::stat(parent.c_str(), &of_parent) == 0 && of_target.st_dev == of_parent.st_dev;
}

bool stays_inside(const fs::path& name) {
  if (name.is_absolute() || !name.has_filename()) return false;
  for (const fs::path& part : name) {
    if (part == ".." || part == ".") return false;
  }
  return true;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target) : target_(resolved(target)) {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_directory(status))
    fail_output(target_, "cannot be written", "not a folder");
  try {
    create_parents();
    create_hidden();
  } catch (...) {
    remove_traces();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  if (!committed_) remove_traces();
}

void OutputFolder::create_parents() {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path parent = target_.parent_path(); !fs::exists(parent, error) && !error;
       parent = parent.parent_path()) {
    // In a current folder that was removed, no path begins anywhere.
    if (parent.empty()) fail_output(target_, "cannot be created", "the current folder is gone");
    missing.insert(missing.begin(), parent);
  }
  for (const fs::path& parent : missing) {
    const bool created = fs::create_directory(parent, error);
    check(error, parent, "cannot be created");
    if (created) created_parents_.insert(created_parents_.begin(), parent);
  }
}

bool OutputFolder::create_hidden_in(const fs::path& folder) {
  auto created = PartialFolder::create(folder, target_.filename());
  if (!created) return false;
  hidden_path_ = created->path();
  hidden_ = std::make_unique<PartialFolder>(std::move(*created));
  return true;
}

void OutputFolder::create_hidden() {
  const fs::path parent = target_.parent_path();
  const bool beside = on_one_device(target_, parent);
  if (beside && create_hidden_in(parent)) return;
  const int reason = errno;
  std::error_code ignored;
  if (fs::is_directory(target_, ignored) && create_hidden_in(target_)) return;
  if (beside) errno = reason;
  fail_with_errno(target_, "cannot be created");
}

void OutputFolder::remove_traces() noexcept {
  std::error_code ignored;
  // Without its lock first: where no descriptor is left, that is the one to look into it.
  const bool is_there = hidden_ != nullptr;
  hidden_.reset();
  if (is_there) fs::remove_all(hidden_path_, ignored);
  for (const fs::path& parent : created_parents_) ::rmdir(parent.c_str());
}

void OutputFolder::write(const fs::path& name, std::string_view content) {
  write(name, [&](const TextSink& sink) { sink(content); });
}

void OutputFolder::write(const fs::path& name,
                         const std::function<void(const TextSink&)>& content) {
  if (committed_)
    fail_output(target_ / name, "cannot be written", "the folder is already in place");
  if (!stays_inside(name))
    fail_output(name, "cannot be written", "not a file name within the folder");
  const fs::path path = hidden_path_ / name;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  check(error, path.parent_path(), "cannot be created");
  Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL);
  content([&](std::string_view piece) { file.write_all(piece); });
  file.sync();
  names_.push_back(name);
}

void OutputFolder::remove_earlier(const std::vector<fs::path>& names) {
  for (const fs::path& name : names) {
    if (!stays_inside(name))
      fail_output(name, "cannot be removed", "not a file name within the folder");
    earlier_.push_back(name);
  }
}

void OutputFolder::put_last(const fs::path& name) { last_ = name; }

bool OutputFolder::is_written(const fs::path& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

void OutputFolder::move_files() {
  std::error_code error;
  for (const fs::path& name : names_) {
    const fs::path path = target_ / name;
    if (fs::is_directory(path, error)) fail_output(path, "cannot be replaced", "is a folder");
    refuse_input(path);
    fs::create_directories(path.parent_path(), error);
    check(error, path.parent_path(), "cannot be created");
  }
  for (const fs::path& name : earlier_) refuse_input(target_ / name);
  FileMoves moves(hidden_path_, target_);
  if (!last_.empty()) moves.put_aside(last_);
  for (const fs::path& name : names_)
    if (name != last_) moves.put(name);
  for (const fs::path& name : earlier_)
    if (!is_written(name)) moves.take_away(name);
  if (is_written(last_)) moves.put(last_);
  moves.keep();
  if (!last_.empty()) fs::remove(set_aside(target_ / last_), error);
  fs::remove_all(hidden_path_, error);
}

void OutputFolder::commit() {
  if (committed_) fail_output(target_, "cannot be committed", "the folder is already in place");
  sync_folder(hidden_path_);
  FolderEntries parent(target_.parent_path(), target_);
  if (::rename(hidden_path_.c_str(), target_.c_str()) != 0) {
    const bool filled = errno == ENOTEMPTY || errno == EEXIST;
    const bool inside = hidden_path_.parent_path() == target_;
    if (!filled && !inside) fail_with_errno(target_, "cannot be put in place");
    move_files();
  }
  committed_ = true;
  for (const fs::path& name : names_) remember_output(target_ / name);
  hidden_.reset();
  parent.sync();
}

}  // namespace posemix
