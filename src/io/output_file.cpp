// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_file.hpp"

#include <atomic>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "descriptor.hpp"

namespace posemix {
namespace {

using namespace internal;

namespace fs = std::filesystem;

constexpr unsigned kMostPartialFiles = 1000;

/// A new file beside a target, which is removed at the end of its scope unless it has been put in
/// the target's place.
class PartialFile {
 public:
  /// A file that is replaced keeps its permissions, from before there is any content.
  explicit PartialFile(const fs::path& target)
      : target_(target), folder_(target.parent_path(), target), file_(create()) {
    std::error_code is_new;
    const fs::file_status before = fs::status(target_, is_new);
    if (!is_new && fs::exists(before))
      fs::permissions(path_, before.permissions() & fs::perms::all, is_new);
  }
  ~PartialFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void write(std::string_view content) {
    file_.write_all(content);
    file_.sync();
  }
  void put_in_place() {
    if (std::rename(path_.c_str(), target_.c_str()) != 0)
      fail_with_errno(target_, "cannot be replaced");
    folder_.sync();
  }

 private:
  /// Neither a file of another thread nor a link that somebody has put there is written to.
  Descriptor create() {
    static std::atomic<unsigned> count = 0;
    for (unsigned attempt = 0;; ++attempt) {
      path_ = target_.parent_path() /
              fmt::format(".{}.partial-{}-{}", target_.filename().string(), ::getpid(), ++count);
      std::error_code error;
      const bool is_taken = fs::exists(fs::symlink_status(path_, error));
      if (!is_taken || attempt == kMostPartialFiles)
        return Descriptor(path_, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, target_);
    }
  }

  fs::path target_;
  fs::path path_;
  FolderEntries folder_;  ///< opened first: once the target is replaced, descriptors may be used up
  Descriptor file_;
};

}  // namespace

void write_output_file(const fs::path& path, std::string_view content) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) fail_output(path, "cannot be written", "is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    Descriptor(path, O_WRONLY, path, OnSignal::stop).write_all(content);
    return;
  }
  const fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error) fail_output(path, "cannot be written", error.message());
  if (path.empty() || !target.has_filename())
    fail_output(path, "cannot be written", "not a file name");
  PartialFile partial(target);
  partial.write(content);
  partial.put_in_place();
}

}  // namespace posemix
