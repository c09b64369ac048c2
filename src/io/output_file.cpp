// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "posemix/io/output_file.hpp"

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

/// A file that is removed at the end of its scope unless it has been moved to its target.
class PartialFile {
 public:
  explicit PartialFile(const fs::path& target)
      : target_(target),
        path_(target.parent_path() /
              fmt::format(".{}.partial-{}", target.filename().string(), ::getpid())) {}
  ~PartialFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void write(std::string_view content) const {
    Descriptor file(path_, O_WRONLY | O_CREAT | O_TRUNC, target_);
    file.write_all(content);
    file.sync();
  }
  void put_in_place() const {
    if (std::rename(path_.c_str(), target_.c_str()) != 0) {
      fail_with_errno(target_, "cannot be replaced");
    }
    sync_folder(target_.parent_path());
  }

 private:
  fs::path target_;
  fs::path path_;
};

}  // namespace

void write_output_file(const fs::path& path, std::string_view content) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) fail_output(path, "cannot be written", "is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    Descriptor(path, O_WRONLY).write_all(content);
    return;
  }
  const fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error || !target.has_filename()) fail_output(path, "cannot be written", "not a file name");
  const PartialFile partial(target);
  partial.write(content);
  partial.put_in_place();
}

}  // namespace posemix
